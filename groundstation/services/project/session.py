"""What is being worked on: the document with its history, the folder it is kept in, and whether it is saved.

Used from one thread, the window's. Long work runs as jobs beside it, on a document as it was when they began; what they
return is put into the document as it is when they end.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from groundstation.services.project.document import Document
from groundstation.services.project.history import History

DocumentListener = Callable[[Document, Document], None]
"""Called with the document as it was and as it is."""


class Session:
    """One open project, or an unnamed one (`folder` None) that was never saved."""

    def __init__(self, document: Document | None = None, folder: Path | None = None) -> None:
        self._history = History(Document() if document is None else document)
        self._saved = self._history.value
        self._folder = folder
        self._listeners: tuple[DocumentListener, ...] = ()

    @property
    def document(self) -> Document:
        """As it is now."""
        return self._history.value

    @property
    def folder(self) -> Path | None:
        """Where the project is kept."""
        return self._folder

    @property
    def is_saved(self) -> bool:
        """Whether the folder holds the document as it is."""
        return self._saved is self.document

    @property
    def undo_label(self) -> str:
        """What `undo` would take back; empty where there is nothing."""
        return self._history.undo_label

    @property
    def redo_label(self) -> str:
        """What `redo` would do again; empty where there is nothing."""
        return self._history.redo_label

    def subscribe(self, listener: DocumentListener) -> None:
        """Call `listener` after every change from now on."""
        self._listeners += (listener,)

    def open(self, document: Document, folder: Path | None, *, saved: bool = True) -> None:
        """Go on with another document; the history of the old one is forgotten. `saved`: the folder holds it."""
        before, self._folder = self.document, folder
        self._history = History(document)
        self._saved = document if saved else Document()
        self._publish(before)

    def change(self, label: str, document: Document) -> None:
        """Take an edit over as one step that can be undone; `label` says what the user did."""
        before = self.document
        self._history.change(label, document)
        self._publish(before)

    def amend(self, document: Document) -> None:
        """Take over what is no step of its own: the plan that is looked at, the wishes in a form."""
        before, was_saved = self.document, self.is_saved
        self._history.amend(document)
        if was_saved and document.site is before.site and document.plans == before.plans:
            self._saved = document
        self._publish(before)

    def undo(self) -> None:
        """Take the last step back."""
        before = self.document
        self._history.undo()
        self._publish(before)

    def redo(self) -> None:
        """Do again what was taken back."""
        before = self.document
        self._history.redo()
        self._publish(before)

    def saved(self, asked: Document, written: Document, folder: Path) -> None:
        """Note that `asked` was saved in `folder`, where it stands as `written` (with the checksum of its site file).

        Does nothing to a document that has been changed since but for noting the folder.
        """
        self._folder = folder
        if self.document is asked:
            before = self.document
            self._history.amend(written)
            self._saved = written
            self._publish(before)

    def _publish(self, before: Document) -> None:
        if before is not self.document:
            for listener in self._listeners:
                listener(before, self.document)
