"""Resumable state of a training run: raw and averaged weights, optimiser, step, settings."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.foundation.files import write_atomically


@dataclass(slots=True)
class Checkpoint:
    """Everything a run needs to go on exactly where it stopped.

    Attributes
    ----------
    step : int
        Finished optimiser steps.
    network, average : dict of tensors
        Raw weights and their exponential moving average.
    optimiser : dict
    settings : dict
        The run's settings, compared on resume.
    generator : tensor
        State of the noise generator.
    more : dict
        What one kind of training needs beside: plain numbers and text.
    """

    step: int
    network: dict[str, torch.Tensor]
    average: dict[str, torch.Tensor]
    optimiser: dict[str, Any]
    settings: dict[str, Any]
    generator: torch.Tensor
    more: dict[str, Any] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write beside the old checkpoint, then rename: an interrupted save loses nothing.

        Raises
        ------
        ExportError
            The folder cannot be written or the disk is full; the old checkpoint is untouched.
        """
        buffer = io.BytesIO()
        torch.save({name: getattr(self, name) for name in self.__slots__}, buffer)
        write_atomically(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path) -> Checkpoint:
        """Read a checkpoint (weights-only unpickling: no code is run).

        Raises
        ------
        ModelError
            The file is damaged or not a checkpoint.
        """
        try:
            content = torch.load(path, map_location="cpu", weights_only=True)
            return cls(**content)
        except Exception as error:  # torch raises many kinds on a damaged file
            raise ModelError(f"The checkpoint {path} cannot be read; delete it to start afresh.") from error

    def check_settings(self, wanted: dict[str, Any], path: Path) -> None:
        """Refuse to go on with other settings than those the checkpoint at ``path`` was made with.

        Raises
        ------
        ModelError
            Names the settings that differ.
        """
        if self.settings != wanted:
            names = ", ".join(name for name in wanted if self.settings.get(name) != wanted[name])
            raise ModelError(f"The checkpoint {path} was made with other settings ({names}); choose another folder.")
