"""Look at a configuration with the system's Python, before an environment is installed for it.

Without PyYAML only whether the file is there and is text; with it, whether it is YAML and which
keys it has at its top. The rest is checked when the environment is there.
"""

import ast
import sys
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]


def fault(path: Path) -> str | None:
    """What is wrong with the configuration ``path``, in one line; None if nothing is seen."""
    try:
        if path.exists() and not path.is_file():
            return f"{path}: not a file"
        path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        return f"{path}: {error.strerror}"
    except ValueError:
        return f"{path}: not UTF-8 text; save the file as UTF-8"
    told = _in_yaml(path)
    return told and f"{path}: {told}"


def _in_yaml(path: Path) -> str | None:
    try:
        from sidmacib.yaml_text import TextError, read_yaml
    except ImportError:  # no PyYAML
        return None
    try:
        config = read_yaml(path)
    except TextError as error:
        return str(error)
    known = keys()
    unknown = [key for key in config if key not in known] if isinstance(config, dict) else []
    return (
        f"{unknown[0]:.60}: unknown key; the keys here are {', '.join(known)}" if unknown else None
    )


def keys() -> list[str]:
    """The keys at the top of a configuration, from the text of its schema."""
    tree = ast.parse((CHECKOUT / "workflow/schema/study.py").read_text(encoding="utf-8"))
    (study,) = (n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == "Study")
    return [
        field.target.id
        for field in study.body
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
    ]


if __name__ == "__main__":
    sys.path.insert(0, str(CHECKOUT))
    sys.exit(fault(Path(sys.argv[1])))
