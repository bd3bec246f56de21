"""Check a configuration with the system's Python, before an environment is installed for it.

Without PyYAML, only that the file exists and is text. With PyYAML, also that it is YAML and that
its top-level keys are known. The rest is checked once the environment is installed.
"""

import ast
import sys
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]


def fault(path: Path) -> str | None:
    """The first error in the configuration ``path``, as one line; None if none is found."""
    try:
        if path.exists() and not path.is_file():
            return f"{path}: not a file"
        path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        return f"{path}: {error.strerror}"
    except ValueError:
        return f"{path}: not UTF-8 text; save the file as UTF-8"
    message = _in_yaml(path)
    return message and f"{path}: {message}"


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
    return f"{unknown[0]:.60}: unknown key; allowed keys: {', '.join(known)}" if unknown else None


def keys() -> list[str]:
    """The top-level keys of a configuration, read from the source of its schema."""
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
