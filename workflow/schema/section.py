"""What every section of the configuration is."""

from typing import Any

from pydantic import BaseModel, ConfigDict, create_model


class Section(BaseModel):
    """A part of the configuration: no unknown keys, no changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


def section_of(source: Any, **kinds: Any) -> Any:
    """A section with some attributes of ``source`` as its keys, which are also its defaults."""
    keys: dict[str, Any] = {key: (kind, getattr(source, key)) for key, kind in kinds.items()}
    return create_model(f"{type(source).__name__}Keys", __base__=Section, **keys)


def changes_to(section: type[Section]) -> Any:
    """``section`` with every key optional: what is None stays as it is."""
    keys: dict[str, Any] = {
        key: (field.rebuild_annotation() | None, None)
        for key, field in section.model_fields.items()
    }
    return create_model(f"{section.__name__}Changes", __base__=Section, **keys)
