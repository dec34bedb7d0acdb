"""Numbers as the user reads them."""

from __future__ import annotations

import math

from kirigami_studio.foundation.units import MM_PER_INCH
from kirigami_studio.foundation.words import ShownUnit, number, tr

UNKNOWN = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"


def in_unit(mm: float, digits: int) -> str:
    """A length in the shown unit, without the unit; inches have two more digits."""
    return number(mm / ShownUnit.mm(), f".{digits + 2 * ShownUnit.inches}f")


def round_step(least: float, unit: float) -> float:
    """1, 2 or 5 times a power of ten of a unit, at least so much; in what ``unit`` is in."""
    power = 10.0 ** math.floor(math.log10(least / unit))
    return unit * next(step * power for step in (1.0, 2.0, 5.0, 10.0) if unit * step * power >= least * (1 - 1e-9))


def readable_length(mm: float) -> str:
    """Millimetres up to a metre, then metres; or inches."""
    if ShownUnit.inches:
        return tr("{inches:.1f} in", inches=mm / MM_PER_INCH)
    return tr("{mm:.0f} mm", mm=mm) if mm < 1000 else tr("{mm:.2f} m", mm=mm / 1000)


def readable_feature(mm: float) -> str:
    """Hundredths of a millimetre below a centimetre, tenths above; or inches."""
    if ShownUnit.inches:
        return tr("{inches:.3f} in", inches=mm / MM_PER_INCH)
    return tr("{mm:.2f} mm", mm=mm) if mm < 10 else tr("{mm:.1f} mm", mm=mm)


def readable_width(mm: float, digits: int = 2) -> str:
    """A connector or a gap: hundredths of a millimetre, or ten-thousandths of an inch."""
    return f"{in_unit(mm, digits)} {ShownUnit.name()}"


def readable_place(x_mm: float, y_mm: float) -> str:
    """A place on the drawing board."""
    x, y = (number(side / ShownUnit.mm(), ".4g") for side in (x_mm, y_mm))
    return tr("{x}, {y} {unit}", x=x, y=y, unit=ShownUnit.name())


def readable_box(width_mm: float, height_mm: float, form: str = ".4g") -> str:
    """Width and height of what is drawn or was read, with as many digits as matter."""
    width, height = (number(side / ShownUnit.mm(), form) for side in (width_mm, height_mm))
    return f"{width} {TIMES} {height} {ShownUnit.name()}"


def readable_time(seconds: float) -> str:
    """Seconds up to two minutes, minutes up to two hours, then hours."""
    if seconds < 120:
        return tr("{seconds:.0f} s", seconds=seconds)
    if seconds < 7200:
        return tr("{seconds:.1f} min", seconds=seconds / 60)
    return tr("{hours:.1f} h", hours=seconds / 3600)


def rough_time(seconds: float) -> str:
    """An estimated time in whole minutes up to an hour and a half, then in whole hours."""
    if seconds < 90.0 * 60.0:
        return tr("{minutes:.0f} min", minutes=max(seconds / 60.0, 1.0))
    return tr("{hours:.0f} h", hours=seconds / 3600.0)


def readable_range(low: float, high: float) -> str:
    """A time that is known within bounds, in one unit; one number where both read alike."""
    if readable_time(low) == readable_time(high):
        return readable_time(low)
    if high < 120:
        return tr("{low:.0f}\N{EN DASH}{high:.0f} s", low=low, high=high)
    if high < 7200:
        return tr("{low:.1f}\N{EN DASH}{high:.1f} min", low=low / 60, high=high / 60)
    return tr("{low:.1f}\N{EN DASH}{high:.1f} h", low=low / 3600, high=high / 3600)


def readable_mm(mm: float) -> str:
    """A length without needless digits."""
    return f"{number(mm / ShownUnit.mm(), '.4g')} {ShownUnit.name()}"


def readable_size(width_mm: float, height_mm: float) -> str:
    """A sheet's two sides."""
    if ShownUnit.inches:
        return readable_box(width_mm, height_mm, ".2f")
    return tr("{width_mm:.0f} \N{MULTIPLICATION SIGN} {height_mm:.0f} mm", width_mm=width_mm, height_mm=height_mm)


def readable_area(mm2: float) -> str:
    """Three digits, all of them before the point where there are more."""
    if ShownUnit.inches:
        return tr("{inches2:.3g} in²", inches2=mm2 / MM_PER_INCH**2)
    return tr("{mm2:.0f} mm²", mm2=mm2) if mm2 >= 100.0 else tr("{mm2:.3g} mm²", mm2=mm2)
