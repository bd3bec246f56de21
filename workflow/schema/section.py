"""What all sections of the configuration have in common."""

from typing import Any

from pydantic import BaseModel, ConfigDict, create_model


class Section(BaseModel):
    """A part of the configuration, without unknown keys; it does not change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


def section_of(source: Any, **kinds: Any) -> Any:
    """A section whose keys and defaults are attributes of ``source``; ``kinds``: their types."""
    keys: dict[str, Any] = {key: (kind, getattr(source, key)) for key, kind in kinds.items()}
    return create_model(f"{type(source).__name__}Keys", __base__=Section, **keys)


def changes_to(section: type[Section]) -> Any:
    """``section`` with every key optional: None means no change."""
    keys: dict[str, Any] = {
        key: (field.rebuild_annotation() | None, None)
        for key, field in section.model_fields.items()
    }
    return create_model(f"{section.__name__}Changes", __base__=Section, **keys)
