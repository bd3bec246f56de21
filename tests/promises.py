"""Examples whose comments promise what they print."""

import ast
import contextlib
import io
import re
import tokenize
from typing import Any

import pytest

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d*)?(?:e[-+]?\d+)?(?![\w])")


def require_kept(code: str, names: dict[str, Any]) -> None:
    """Run ``code`` in ``names``; fail unless prints give the numbers in comments behind them."""
    outputs, promises = printed(code, names), promised(code)
    assert promises, "an example that promises nothing"
    for line, numbers in promises.items():
        found = NUMBER.findall(outputs[line])
        assert len(found) == len(numbers), f"{code.splitlines()[line - 1]}: {outputs[line]}"
        for number, value in zip(numbers, found, strict=True):
            last_digit = 10.0 ** -len(number.partition(".")[2])
            assert float(value) == pytest.approx(float(number), abs=last_digit / 2)


def promised(code: str) -> dict[int, list[str]]:
    """Numbers in the comments behind prints, by line."""
    lines = code.splitlines()
    comments = {
        token.start[0]: token.string
        for token in tokenize.generate_tokens(io.StringIO(code).readline)
        if token.type == tokenize.COMMENT
    }
    found = {n: NUMBER.findall(text) for n, text in comments.items() if "print(" in lines[n - 1]}
    return {number: values for number, values in found.items() if values}


def printed(code: str, names: dict[str, Any]) -> dict[int, str]:
    """What each statement of ``code`` prints, by its first line."""
    found = {}
    for statement in ast.parse(code).body:
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(ast.Module([statement], []), "example", "exec"), names)
        found[statement.lineno] = output.getvalue()
    return found
