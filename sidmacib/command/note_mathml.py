"""Equations in MathML, which browsers show without further files."""


def name(symbol: str, index: str = "") -> str:
    """A symbol, with an ``index`` if it has one."""
    one = f"<mi>{symbol}</mi>"
    return f"<msub>{one}<mi>{index}</mi></msub>" if index else one


def number(value: float, unit: str = "") -> str:
    """A number with four digits, and its unit."""
    text, power, exponent = f"{value:.4g}".partition("e")
    shown = f"<mn>{text}</mn>"
    if power:
        shown += f"<mo>·</mo><msup><mn>10</mn><mn>{int(exponent)}</mn></msup>"
    return shown + (f"<mspace width='0.25em'/><mtext>{unit}</mtext>" if unit else "")


def fraction(over: str, under: str) -> str:
    """One part over the other."""
    return f"<mfrac><mrow>{over}</mrow><mrow>{under}</mrow></mfrac>"


def root(inside: str) -> str:
    """A square root."""
    return f"<msqrt>{inside}</msqrt>"


def equation(*sides: str) -> str:
    """Sides that are equal, in a line of their own."""
    return f'<div class="step"><math>{"<mo>=</mo>".join(sides)}</math></div>'
