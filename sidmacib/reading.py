"""Sections of files, read by pydantic: keys, units, ranges and defaults stand in their fields.

Every fault is one line that names the key, its value and what is allowed. The schemas for editors
and the pages of keys are made from the same fields.
"""

import math
import re
from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StrictBool,
    ValidationError,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError

from sidmacib.quantities import FORMULA, Number, meant, shown
from sidmacib.validation import LARGE, SMALL, kinds_of

Some = Field(min_length=1)


class Section(BaseModel):
    """Keys and values of a part of a file, without unknown keys; they do not change later."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        ser_json_inf_nan="strings",
        use_attribute_docstrings=True,
    )

    @model_validator(mode="before")
    @classmethod
    def _known(cls, given: Any) -> Any:
        for name in given if isinstance(given, Mapping) else ():
            if name not in cls.model_fields:
                near, every = meant(str(name), cls.model_fields), ", ".join(cls.model_fields)
                allowed = f"unknown key; {near}allowed keys: {every}"
                raise PydanticCustomError("of_key", "{words}", {"key": name, "words": allowed})
        return given

    @classmethod
    def read(cls, value: Any, *place: str) -> Self:
        """The section in plain values; ``place``: its keys. ValueError, of its first fault."""
        try:
            return cls.model_validate(value)
        except ValidationError as error:
            raise ValueError(faults(error, *place)[0]) from None


class _Made(Section):
    """A section made here, whose fields have no source with docstrings to search for."""

    model_config = ConfigDict(use_attribute_docstrings=False)


def section_of(source: Any, *keys: str, **kinds: Any) -> Any:
    """A section of some fields of the dataclass ``source``, or all, with its defaults.

    ``source`` may be an instance, whose values are the defaults then. ``kinds``: annotations that
    are narrower than those of the dataclass.
    """
    dataclass: Any = source if isinstance(source, type) else type(source)
    every = {**kinds_of(dataclass), **kinds}
    chosen: dict[str, Any] = {
        key: (StrictBool if every[key] is bool else every[key], getattr(source, key, ...))
        for key in keys or every
    }
    return create_model(f"{dataclass.__name__}Keys", __base__=_Made, **chosen)


def changes_to(section: type[Section]) -> Any:
    """``section`` with every key optional: None means no change."""
    keys: dict[str, Any] = {
        key: (field.rebuild_annotation() | None, None)
        for key, field in section.model_fields.items()
    }
    return create_model(f"{section.__name__}Changes", __base__=_Made, **keys)


_Component = Annotated[float, Number(at_least=-LARGE, at_most=LARGE)]
_Coordinate = Annotated[float, Number(at_least=-LARGE, at_most=LARGE, unit="m")]


def _listed(count: int, words: str) -> Any:
    """Annotations of a list of as many numbers, in ``words``."""

    def checked(value: Any) -> Any:
        if not isinstance(value, list | tuple) or len(value) != count:
            raise ValueError(f"{shown(value)} is not allowed; it must be {words}")
        return value

    return BeforeValidator(checked), Field(json_schema_extra={"allowed": words})


def _way(value: tuple[float, float, float]) -> tuple[float, float, float]:
    if not math.hypot(*value) > SMALL:
        raise ValueError(f"{list(value)} is not allowed; it must be three numbers, not all 0")
    return value


_THREE = _listed(3, "a list of three numbers")
PlanPoint = Annotated[tuple[_Coordinate, _Coordinate], *_listed(2, "a list of x and y")]  # m
Vector = Annotated[tuple[_Coordinate, _Coordinate, _Coordinate], *_THREE]  # m
Way = Annotated[tuple[_Component, _Component, _Component], *_THREE, AfterValidator(_way)]


class Keys(Section):
    """Keys of a structure's file, which has no null."""

    @model_validator(mode="before")
    @classmethod
    def _given(cls, values: Any) -> Any:
        if isinstance(values, Mapping):
            for key, value in values.items():
                if value is None:
                    raise ValueError(f"{key}: null is not allowed; give a value, or no {key}")
        return values


def label(value: Any) -> Any:
    """Printable text, no formula of a spreadsheet: names stand in tables."""
    text = str(value).strip()
    if not text or not str(value).isprintable():
        raise ValueError(f"{shown(value)} is not allowed; names must be printable")
    if text.startswith(FORMULA):
        raise ValueError(
            f"{shown(value)} is not allowed; names must not begin with {' '.join(FORMULA)}, as a "
            "spreadsheet would take them for formulas"
        )
    return value


Text = Annotated[str, Field(coerce_numbers_to_str=True)]
Label = Annotated[Text, BeforeValidator(label)]


def shown_key(key: Any) -> str:
    """A key as shown in a message: unchanged if it is a short word."""
    plain = isinstance(key, int) or (isinstance(key, str) and re.fullmatch(r"[\w.+-]{1,80}", key))
    return str(key) if plain else shown(key)


_MAPPING = "a mapping of keys to values"
_EXPECTED = {
    "model_type": _MAPPING,
    "model_attributes_type": _MAPPING,
    "dict_type": _MAPPING,
    "tuple_type": "a list",
    "list_type": "a list",
    "string_type": "a text",
    "bool_type": "true or false",
}


def faults(error: ValidationError, *place: str) -> list[str]:
    """A line for each fault in what stands at ``place``; entries of lists are counted from 1."""
    found = error.errors(include_url=False)
    # A list is too short for pydantic, too, if only its entries are faulty.
    real = [each for each in found if each["type"] != "too_short" or not each["input"]]
    return [_line([*place, *each["loc"]], each) for each in real]


def _line(place: list[Any], fault: Any) -> str:
    kind, context = fault["type"], fault.get("ctx", {})
    if place[-1:] == ["[key]"]:
        place = place[:-2]
    if kind == "of_key":
        place, words = [*place, context["key"]], context["words"]
    elif kind == "value_error":  # raised by this project
        words = str(context["error"])
    elif kind == "missing":
        words = "missing; this key is required"
    else:
        expected = context.get("expected", "").replace("'", "") or _EXPECTED.get(kind)
        if kind == "too_short":
            named = context["field_type"] == "Dictionary"
            expected = "a mapping of at least one name" if named else "a list of at least one value"
        words = f"; it must be {expected}" if expected else f"; {fault['msg']}"
        words = f"{shown(fault['input'])} is not allowed{words}"
    keys = [shown_key(key + 1 if type(key) is int else key) for key in place]
    between = "." if re.match(r"[a-z_.]+: ", words) else ": "
    return f"{'.'.join(keys)}{between}{words}" if keys else words
