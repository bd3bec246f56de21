"""The base of all sections of the configuration."""

from typing import Any

from pydantic import BaseModel, ConfigDict, create_model

from sidmacib.fields import kinds_of
from workflow.schema.values import Switch


class Section(BaseModel):
    """A part of the configuration, without unknown keys; it does not change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


def section_of(source: Any, *keys: str, **kinds: Any) -> Any:
    """A section of some fields of the dataclass ``source``, or all, with its defaults.

    ``source`` may be an instance, whose values are the defaults then. ``kinds``: annotations that
    are narrower than those of the dataclass. Where it has a ``bool``, the section takes nothing
    but true and false.
    """
    dataclass: Any = source if isinstance(source, type) else type(source)
    fields_of = {key: Switch if kind is bool else kind for key, kind in kinds_of(dataclass).items()}
    annotations = {**fields_of, **kinds}
    chosen: dict[str, Any] = {
        key: (annotations[key], getattr(source, key, ...)) for key in keys or annotations
    }
    return create_model(f"{dataclass.__name__}Keys", __base__=Section, **chosen)


def changes_to(section: type[Section]) -> Any:
    """``section`` with every key optional: None means no change."""
    keys: dict[str, Any] = {
        key: (field.rebuild_annotation() | None, None)
        for key, field in section.model_fields.items()
    }
    return create_model(f"{section.__name__}Changes", __base__=Section, **keys)
