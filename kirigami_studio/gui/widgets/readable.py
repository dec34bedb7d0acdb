"""Numbers as the user reads them."""

from __future__ import annotations

from kirigami_studio.foundation.words import tr

UNKNOWN = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"


def readable_length(mm: float) -> str:
    """Millimetres up to a metre, then metres."""
    return tr("{mm:.0f} mm", mm=mm) if mm < 1000 else tr("{mm:.2f} m", mm=mm / 1000)


def readable_feature(mm: float) -> str:
    """Hundredths of a millimetre below a centimetre, tenths above."""
    return tr("{mm:.2f} mm", mm=mm) if mm < 10 else tr("{mm:.1f} mm", mm=mm)


def readable_time(seconds: float) -> str:
    """Seconds up to two minutes, then minutes."""
    return tr("{seconds:.0f} s", seconds=seconds) if seconds < 120 else tr("{seconds:.1f} min", seconds=seconds / 60)


def readable_range(low: float, high: float) -> str:
    """A time that is known within bounds, in one unit; one number where both read alike."""
    if readable_time(low) == readable_time(high):
        return readable_time(low)
    if high < 120:
        return tr("{low:.0f}\N{EN DASH}{high:.0f} s", low=low, high=high)
    return tr("{low:.1f}\N{EN DASH}{high:.1f} min", low=low / 60, high=high / 60)


def readable_size(width_mm: float, height_mm: float) -> str:
    """A sheet's two sides."""
    return tr("{width_mm:.0f} \N{MULTIPLICATION SIGN} {height_mm:.0f} mm", width_mm=width_mm, height_mm=height_mm)


def readable_area(mm2: float) -> str:
    """Three digits, all of them before the point where there are more."""
    return tr("{mm2:.0f} mm²", mm2=mm2) if mm2 >= 100.0 else tr("{mm2:.3g} mm²", mm2=mm2)
