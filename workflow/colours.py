"""Colours that people with any kind of colour vision tell apart (Okabe and Ito, 2008)."""

BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, OCHRE, BLACK, GREY = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8a6d00", "#000000"),
    "#9aa0aa",
)
