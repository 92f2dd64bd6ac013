"""STEP files (ISO 10303-21), as IFC models are: whether one is whole, and which of its names are none."""

from __future__ import annotations

from pathlib import Path

from planning.errors import InputError

MAX_FILE_BYTES = 4 * 2**30

TAIL_BYTES = 4096
"""The end mark stands in the last few; some programs write a comment after it."""

NOT_NAMES = frozenset(
    (
        *("", "unnamed", "not named", "untitled", "no name", "noname", "name", "undefined", "unknown", "unspecified"),
        *("not defined", "notdefined", "not specified", "not set", "none", "null", "nil", "n/a", "na", "tbd", "tbc"),
        *("default", "default name", "default building", "default site", "default project", "standard", "test", "new"),
        *("building", "building name", "my building", "new building", "the building", "ifcbuilding", "ifc building"),
        *("project", "project name", "project number", "project status", "project address", "project issue date"),
        *("my project", "new project", "site", "site name", "my site", "address", "enter address here", "owner"),
        *("client name", "author", "organization name", "building description"),
        # German, Spanish, French, Italian, Portuguese, Dutch, Polish, Czech, Russian, Chinese, Japanese.
        *(
            "unbenannt",
            "ohne namen",
            "kein name",
            "gebäude",
            "projekt",
            "projektname",
            "projektnummer",
            "projektstatus",
        ),
        *("undefiniert", "nicht definiert", "unbekannt", "vorgabe", "gelände", "grundstück", "liegenschaft"),
        *("sin nombre", "edificio", "nombre de proyecto", "número de proyecto", "estado de proyecto", "proyecto"),
        *("por defecto", "predeterminado", "indefinido", "sans nom", "bâtiment", "nom du projet", "numéro du projet"),
        *("état du projet", "par défaut", "non défini", "défaut", "senza nome", "predefinito", "nome progetto"),
        *("sem nome", "edifício", "padrão", "naamloos", "gebouw", "standaard", "projectnaam", "bez nazwy", "budynek"),
        *(
            "nepojmenováno",
            "budova",
            "без имени",
            "здание",
            "не определено",
            "未命名",
            "建筑",
            "默认",
            "项目名称",
            "無題",
        ),
    )
)
"""What BIM programs write where nobody has given a name, in lower case."""

COUNTED = frozenset(("unnamed", "untitled", "undefined", "default", "unbenannt", "sin nombre", "sans nom", "未命名"))
"""Among them those that are none with a number either; "Building 12" is a name."""

START, END = b"ISO-10303-21", b"END-ISO-10303-21"


def check_ends(path: Path) -> None:
    """Refuse what is no STEP file or is cut off: IfcOpenShell reads what is left of it without a word.

    Raises
    ------
    InputError
        As said.
    """
    try:
        if not path.is_file():
            raise InputError(f"{path}: there is no such file")
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(64)
            file.seek(max(0, size - TAIL_BYTES))
            tail = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if size > MAX_FILE_BYTES:
        raise InputError(f"{path}: the file has more than {MAX_FILE_BYTES // 2**30} GiB; export the facade alone")
    if not head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(START):
        raise InputError(f"{path}: expected an IFC file (STEP text that begins with ISO-10303-21)")
    if END not in tail:
        raise InputError(f"{path}: the file is cut off (END-ISO-10303-21 is missing); copy or export it again")


def real_name(*names: object) -> str:
    """The first of several names that somebody has given, without blanks around it; empty where there is none.

    Programs fill in placeholders ("Unnamed", "$", "Default", "Project Number"), also with marks or a number behind.
    """
    for name in names:
        text = " ".join(str(name or "").split())
        plain = text.replace("_", " ").strip(" .,:;#<>()[]{}*$?!'\"/\\|+~=-").casefold()
        if plain not in NOT_NAMES and plain.rstrip("0123456789 #.:-") not in COUNTED:
            return text
    return ""
