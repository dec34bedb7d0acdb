"""Numbers as a person reads them."""

from __future__ import annotations

UNKNOWN = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"


def readable_length(mm: float) -> str:
    """Millimetres up to a metre, then metres."""
    return f"{mm:.0f} mm" if mm < 1000 else f"{mm / 1000:.2f} m"


def readable_time(seconds: float) -> str:
    """Seconds up to two minutes, then minutes."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def readable_range(low: float, high: float) -> str:
    """A time that is known within bounds, in one unit; one number where both read alike."""
    if readable_time(low) == readable_time(high):
        return readable_time(low)
    if high < 120:
        return f"{low:.0f}{UNKNOWN}{high:.0f} s"
    return f"{low / 60:.1f}{UNKNOWN}{high / 60:.1f} min"


def readable_size(width_mm: float, height_mm: float) -> str:
    """A sheet's two sides."""
    return f"{width_mm:.0f} {TIMES} {height_mm:.0f} mm"


def readable_area(mm2: float) -> str:
    """Three digits, all of them before the point where there are more."""
    return f"{mm2:.0f} mm²" if mm2 >= 100.0 else f"{mm2:.3g} mm²"
