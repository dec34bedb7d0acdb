"""Where to train: the accelerator when there is one, otherwise the processor."""

from __future__ import annotations

import torch

from kirigami_studio.foundation.errors import UsageError


def training_device(name: str, threads: int = 1) -> torch.device:
    """Resolve ``auto``, ``cpu`` or ``cuda``, and give torch that many processor threads.

    Raises
    ------
    UsageError
        The device does not exist on this machine, or fewer than one thread was asked for.
    """
    if threads < 1:
        raise UsageError(f"Training needs at least 1 thread, got {threads}.")
    torch.set_num_threads(threads)
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if name == "cuda" and not torch.cuda.is_available():
        raise UsageError("No CUDA device is available to this torch build; use --device cpu or install a GPU build.")
    try:
        return torch.device(name)
    except RuntimeError as error:
        raise UsageError(f"Unknown device '{name}'; use auto, cpu or cuda.") from error
