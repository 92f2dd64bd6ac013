"""Use cases of records: making a book, looking into it, changing it, and bringing it in and out as CSV and IFC."""

from __future__ import annotations

import getpass
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import plain_values
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import ObjectsSet, RecordBook
    from reconstruction.records.entries import Entry, Value
    from reconstruction.records.objects import ObjectRow
    from reconstruction.records.queries import ObjectFilter


# The records that lie beside a scene of objects: which objects they are of, and the files that they keep.


def user_name() -> str:
    """Who is at the computer, for the history."""
    try:
        return getpass.getuser()[:200] or "unknown"
    except (OSError, KeyError, ImportError):
        return "unknown"


def book_of_scene(folder: Path, who: str) -> RecordBook:
    """The records of a scene, opened for writing; a new book where there was none.

    Raises
    ------
    InputError
        The scene or the book cannot be read or written.
    """
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import FILE, RecordBook, make_book

    path = folder / FILE
    if path.exists():
        book = RecordBook(path, True, who)
        if book.objects(with_absent=True):
            return book
        # A program ended between making the book and telling it of the objects.
    else:
        StoredScene(folder)
        make_book(path)
        book = RecordBook(path, True, who)
    scene = StoredScene(folder)
    book.set_objects(object_rows(scene), scene.origin)
    return book


def with_file(book: RecordBook, entry: Entry, file: Path | None) -> Entry:
    """A defect with its picture, or a document with its file, of which the records keep a copy.

    Raises
    ------
    InputError
        The file cannot be read or kept, or is no picture.
    """
    from reconstruction.records.entries import Defect, Document
    from reconstruction.records.stored_files import store_document, store_picture

    if file is not None and isinstance(entry, Defect):
        return replace(entry, picture=store_picture(book, file).name)
    if file is not None and isinstance(entry, Document):
        stored = store_document(book, file)
        return replace(entry, place=stored.name, sha256=stored.sha256)
    return entry


@dataclass(frozen=True, slots=True)
class Attachment:
    """A file that a record names, as far as it is there.

    Parameters
    ----------
    n_bytes
        0 where it is missing, or not the one that was stored.
    picture
        A small JPEG of it, where it is a picture that can be read.
    """

    n_bytes: int = 0
    picture: bytes | None = None


def attachments_of(
    folder: Path, entries: Iterable[Entry], longest_px: int, monitor: Monitor = QUIET
) -> dict[str, Attachment]:
    """Stored files of defects and documents, by their names beside the records.

    Parameters
    ----------
    longest_px
        Side of the pictures.

    Raises
    ------
    InputError
        The records cannot be read.
    """
    from reconstruction.exports.page_records import PICTURES, small_jpeg
    from reconstruction.records.book import FILE, RecordBook
    from reconstruction.records.entries import Defect, Document, is_address
    from reconstruction.records.stored_files import DOCUMENT_FILE, stored_path

    names = {each.picture for each in entries if isinstance(each, Defect) and each.picture}
    names |= {each.place for each in entries if isinstance(each, Document) and not is_address(each.place)}
    found: dict[str, Attachment] = {}
    if not names:
        return found
    with RecordBook(folder / FILE) as book:
        for number, name in enumerate(sorted(names)):
            monitor.report(say("reading what is attached"), number, len(names))
            found[name] = Attachment()
            with suppress(InputError):
                content = read_input_file(stored_path(book, name), DOCUMENT_FILE)
                found[name] = Attachment(len(content))
                if name.endswith(PICTURES):
                    found[name] = Attachment(len(content), small_jpeg(name, content, longest_px))
    return found


def update_objects(folder: Path, who: str) -> None:
    """Tell the records of a scene, where there are any, which objects it has now.

    Raises
    ------
    InputError
        The scene or the book cannot be read or written.
    """
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import FILE, RecordBook

    if (folder / FILE).exists():
        scene = StoredScene(folder)
        with RecordBook(folder / FILE, True, who) as book:
            book.set_objects(object_rows(scene), scene.origin)


def object_rows(scene: StoredScene) -> tuple[ObjectRow, ...]:
    """Objects of a scene as records know them."""
    from reconstruction.records.objects import ObjectRow

    rows = [ObjectRow(scene.global_id, "scene", None, scene.name)]
    for head in scene.heads:
        rows.append(ObjectRow(head.global_id, "component", scene.global_id, head.name))
        rows += [
            ObjectRow(element.global_id, "element", head.global_id, element.name, element.corners_enu_m)
            for element in head.elements
        ]
    return tuple(rows)


@dataclass(frozen=True, slots=True)
class Exported:
    """Files that were written, and what the user should know about them."""

    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Imported:
    """What came of an import: records added or changed by file or kind, and what was left out."""

    n_changed: dict[str, int]
    notes: tuple[str, ...] = ()


def records_path(folder: Path) -> Path:
    """File of the records of a model."""
    from reconstruction.records.book import FILE

    return folder / FILE


def open_records(folder: Path, writing: bool = False, who: str | None = None) -> RecordBook:
    """Records of a model.

    Parameters
    ----------
    who
        Name for the history; None: who is at the computer.

    Raises
    ------
    InputError
        There are none (the message says how to make them), or they are damaged, newer, or none of ours.
    """
    from reconstruction.records.book import RecordBook

    if not folder.is_dir():
        raise InputError(
            say(
                "expected the folder of a model; 'records FOLDER make --objects SITE' makes one for records alone",
                place=folder,
            )
        )
    if not records_path(folder).exists():
        from reconstruction.objects.store import DESCRIPTION
        from reconstruction.training.parameters import MODEL

        if (folder / DESCRIPTION).is_file():
            raise InputError(say("there are no records yet; make them with 'records FOLDER make'", place=folder))
        if (folder / MODEL).is_file():
            raise InputError(
                say(
                    "is a trained model; records belong to its objects, of which 'organise' makes a folder",
                    place=folder,
                )
            )
    return RecordBook(records_path(folder), writing, user_name() if who is None else who)


def make_records(folder: Path, site_path: Path | None = None, who: str | None = None) -> ObjectsSet:
    """Make records, or bring those that are there up to the objects that there are now.

    Parameters
    ----------
    site_path
        Of whose facades and panels; None: of the scene in the folder.

    Raises
    ------
    InputError
        Site or scene cannot be read, or the file cannot be written.
    """
    from groundstation.services.project.input_files import read_input_site
    from planning.base.files import make_folder
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import make_book
    from reconstruction.records.objects import site_objects

    if site_path is None:
        scene = StoredScene(folder)
        rows, origin = object_rows(scene), scene.origin
    else:
        site = read_input_site(site_path).site
        rows, origin = site_objects(site), site.origin
    make_folder(folder)
    if not records_path(folder).exists():
        make_book(records_path(folder))
    with open_records(folder, True, who) as book:
        return book.set_objects(rows, origin)


def object_lines(book: RecordBook, object_filter: ObjectFilter) -> list[dict[str, Any]]:
    """Objects with what matters most about them: latest inspection, worst open defect."""
    from reconstruction.records.queries import find_objects, latest_inspections, worst_open_defects

    with book.database.snapshot():
        rows = find_objects(book, object_filter)
        inspections, defects = latest_inspections(book), worst_open_defects(book)
    lines = []
    for row in rows:
        inspection, defect = inspections.get(row.global_id), defects.get(row.global_id)
        lines.append(
            {
                **_object(row),
                "last_inspection": None if inspection is None else inspection.date,
                "result": None if inspection is None else inspection.result,
                "worst_open_defect": None if defect is None else defect.kind,
                "severity": None if defect is None else defect.severity,
            }
        )
    return lines


def filter_value(book: RecordBook, attribute: str, text: str) -> Value:
    """Value that an attribute has where a filter says `text`, by the type of the attribute.

    Raises
    ------
    InputError
        It is no such value.
    """
    from reconstruction.records.csv import read_number, read_value
    from reconstruction.records.entries import COMPUTED
    from reconstruction.records.queries import attribute_type

    if attribute in COMPUTED:
        return read_number(text, attribute, False)
    return read_value(attribute_type(book, attribute) or "text", text, attribute)


def object_content(book: RecordBook, name: str) -> dict[str, Any]:
    """All records of one object, by table.

    Raises
    ------
    InputError
        There is no such object.
    """
    from reconstruction.records.entries import KINDS

    with book.database.snapshot():
        row = book.object(name)
        content = {
            **_object(row),
            "present": book.is_present(row.global_id),
            "corners_enu_m": row.corners_enu_m,
        }
        for kind in KINDS:
            content[kind.table] = [plain_values(entry) for entry in book.entries(kind.record, row.global_id)]
    return content


def plain_records(book: RecordBook) -> dict[str, list[dict[str, Any]]]:
    """All entries of all objects by GlobalId, as plain values with their `record` (such as `defect`) first."""
    from reconstruction.records.entries import KINDS

    found: dict[str, list[dict[str, Any]]] = {}
    with book.database.snapshot():
        for kind in KINDS:
            for entry in book.entries(kind.record):
                fields = {name: value for name, value in plain_values(entry).items() if name != "global_id"}
                found.setdefault(entry.global_id, []).append({"record": kind.name, **fields})
    return found


def put_fields(book: RecordBook, name: str, kind_name: str, texts: Mapping[str, str]) -> Any:
    """Add an entry from the texts of its fields; pictures and documents that are files are copied beside the records.

    Raises
    ------
    InputError
        There is no such object, kind or field, or a field refuses its value.
    """
    from reconstruction.records.csv import read_field
    from reconstruction.records.entries import KIND_NAMED, Attribute

    kind = KIND_NAMED.get(kind_name)
    if kind is None or kind.record is Attribute:
        known = ", ".join(name for name in KIND_NAMED if name != "attribute")
        raise InputError(say("'{}': expected one of {}", kind_name, known))
    unknown = next((field for field in texts if field not in kind.columns), None)
    if unknown is not None:
        raise InputError(say("a {} has no field '{}'; known are {}", kind_name, unknown, ", ".join(kind.columns)))
    values = {field: read_field(field, text) for field, text in texts.items()}
    values = {field: value for field, value in values.items() if value != ""}
    row = book.object(name)
    _check_required(kind.record, values)
    from reconstruction.records.stored_files import discard_stored

    there = {path.name for path in book.files.glob("*")}
    stored = _with_files(book, values)
    try:
        with book.changing(f"{kind_name} of {row.name}"[:200]) as changes:
            return changes.put(kind.record(global_id=row.global_id, **stored))
    except BaseException:
        discard_stored(book, {str(stored.get(field, "")) for field in ("picture", "place")} - there)
        raise


def _check_required(record: type[Any], values: Mapping[str, Any]) -> None:
    from dataclasses import MISSING, fields

    for field in fields(record):
        if field.default is MISSING and field.name not in values and field.name != "global_id":
            raise InputError(say("expected a value, found none", place=field.name))


def _with_files(book: RecordBook, values: Mapping[str, Any]) -> dict[str, Any]:
    """Fields with files exchanged for their names beside the records."""
    from reconstruction.records.stored_files import store_document, store_picture

    found = dict(values)
    if "picture" in found and not _is_stored(book, found["picture"]):
        found["picture"] = store_picture(book, Path(found["picture"])).name
    if "place" in found and not _is_stored(book, found["place"]) and Path(found["place"]).is_file():
        stored = store_document(book, Path(found["place"]))
        found["place"], found["sha256"] = stored.name, stored.sha256
    return found


def _is_stored(book: RecordBook, name: str) -> bool:
    from reconstruction.records.limits import is_plain_name

    return is_plain_name(name) and (book.files / name).is_file()


def put_attributes(book: RecordBook, name: str, texts: Mapping[str, str]) -> int:
    """Set attributes of an object from heads such as `maker` or `thickness [mm] (number)` and texts; "" takes one out.

    Returns
    -------
    n_changed
        Attributes that are new, other or gone.

    Raises
    ------
    InputError
        There is no such object, or an attribute refuses its value.
    """
    from reconstruction.records.csv import column_of_head, read_value
    from reconstruction.records.entries import Attribute

    row = book.object(name)
    known = {entry.name: entry for entry in book.entries(Attribute, row.global_id)}
    with book.changing(f"attributes of {row.name}"[:200]) as changes:
        for head, text in texts.items():
            attribute, type_name, unit = column_of_head(head.strip())
            if text:
                value = read_value(type_name, text, attribute)
                changes.put(Attribute(row.global_id, attribute, value, type_name, unit))
            elif attribute in known:
                changes.remove(known[attribute])
        return changes.n_changed


def import_records(
    book: RecordBook, path: Path, kind_name: str | None = None, all_sets: bool = False, monitor: Monitor = QUIET
) -> Imported:
    """Take records over from a CSV table, a folder of such, or an IFC file.

    Parameters
    ----------
    kind_name
        What a table holds, where its name does not say.
    all_sets
        Of an IFC file also the property sets of BIM programs' own.

    Raises
    ------
    InputError
        There is no such file, or something in it is wrong: then nothing of it is taken.
    """
    from reconstruction.records.csv import kind_of_table, read_tables, table_name
    from reconstruction.records.entries import KIND_NAMED, KINDS

    if path.suffix.lower() == ".ifc":
        from reconstruction.records.ifc.importing import read_ifc_records

        imported = read_ifc_records(book, path, all_sets, monitor)
        return Imported({path.name: imported.n_changed}, imported.notes)
    if path.is_dir():
        tables = [(path / table_name(kind), kind) for kind in KINDS if (path / table_name(kind)).is_file()]
        if not tables:
            raise InputError(say("holds none of {}", ", ".join(map(table_name, KINDS)), place=path))
    elif kind_name is not None:
        if kind_name not in KIND_NAMED:
            raise InputError(say("expected one of {}, got '{}'", ", ".join(KIND_NAMED), kind_name, place="--kind"))
        tables = [(path, KIND_NAMED[kind_name])]
    else:
        tables = [(path, kind_of_table(path))]
    return Imported({imported.kind: imported.n_changed for imported in read_tables(book, tables)})


def export_tables(book: RecordBook, folder: Path, semicolon: bool = False) -> Exported:
    """Write the records as CSV tables into a folder, see `write_tables`."""
    from reconstruction.records.csv import write_tables

    return Exported(write_tables(book, folder, semicolon))


def export_ifc(
    book: RecordBook, out: Path, original: Path | None = None, site: Path | None = None, monitor: Monitor = QUIET
) -> Exported:
    """Write the records into a copy of an IFC file, or into a new one.

    Parameters
    ----------
    original
        The IFC file that the site came from; None: a new file of facades and panes.
    site
        Site file whose building mesh stands behind the panes of a new file.

    Raises
    ------
    InputError
        A file cannot be read or written.
    """
    if original is None:
        from groundstation.services.project.input_files import read_input_site
        from reconstruction.records.ifc.new import write_new_ifc

        mesh = None if site is None else read_input_site(site).building
        return Exported((out,), write_new_ifc(book, out, mesh))
    if site is not None:
        raise InputError(say("--site goes with a new IFC file; leave out --into or --site"))
    from reconstruction.records.ifc.extract import property_sets
    from reconstruction.records.ifc.importing import extend_copy

    names = {row.global_id: row.name for row in book.objects(with_absent=True)}
    found = extend_copy(original, out, property_sets(book), frozenset(names), monitor)
    if not found.extended and not found.missing:
        return Exported((out,), (say("there are no records to write"),))
    missing = [names[global_id] for global_id in found.missing]
    notes = (say("without an element in this file, so not written: {}", _listed(missing)),) if missing else ()
    return Exported((out,), notes)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:10]) + (say(" and {} more", len(names) - 10) if len(names) > 10 else "")


def _object(row: ObjectRow) -> dict[str, Any]:
    sizes = (None if size is None else round(size, 4) for size in (row.width_m, row.height_m))
    width_m, height_m = sizes
    return {
        "global_id": row.global_id,
        "name": row.name,
        "layer": row.layer,
        "parent": row.parent,
        "width_m": width_m,
        "height_m": height_m,
    }
