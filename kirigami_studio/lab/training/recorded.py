"""A step of training as one CUDA graph: small networks else wait for kernel launches.

A U-Net of two levels on 10 x 10 pixels launches about a thousand kernels a step.  Recorded once and replayed, they
follow each other without the processor's help; the arithmetic is the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import torch
from torch import Tensor

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.training.ranks import Ranks

#: Plain calls before the recording: libraries choose their kernels, and what is tabulated once is tabulated.
WARM_UP_CALLS = 3


class Recorded:
    """A function of tensors that is recorded on the GPU and replayed.

    It may neither wait for the GPU nor change the shapes of what it is given, and its results are overwritten by the
    next call.

    Parameters
    ----------
    function : callable
        Of tensors; returns tensors.
    generator : torch.Generator
        Of the random numbers that it draws, beside torch's own.
    """

    def __init__(self, function: Callable[..., tuple[Tensor, ...]], generator: torch.Generator) -> None:
        self.function, self.generator = function, generator
        self._calls = 0
        self._graph: torch.cuda.CUDAGraph | None = None
        self._inputs: tuple[Tensor, ...] = ()
        self._results: tuple[Tensor, ...] = ()

    def __call__(self, *inputs: Tensor) -> tuple[Tensor, ...]:
        if self._calls < WARM_UP_CALLS:
            self._calls += 1
            return self.function(*inputs)
        if self._graph is None:
            self._graph = self._record(inputs)
        else:
            for own, given in zip(self._inputs, inputs, strict=True):
                own.copy_(given)
        self._graph.replay()
        return self._results

    def _record(self, inputs: tuple[Tensor, ...]) -> torch.cuda.CUDAGraph:
        self._inputs = tuple(given.clone() for given in inputs)
        graph = torch.cuda.CUDAGraph()
        graph.register_generator_state(self.generator)
        # Other threads may train other networks on the same GPU meanwhile.
        stream = torch.cuda.current_stream()
        with torch.cuda.graph(graph, stream=stream, capture_error_mode="thread_local"):
            self._results = self.function(*self._inputs)
        return graph


@contextmanager
def own_stream(device: torch.device, recorded: bool) -> Iterator[None]:
    """Train on a stream of this run's own where steps are recorded: the usual one cannot be.

    Raises
    ------
    UsageError
        Recorded steps were asked for, and the network is on no GPU, or several processes train it.
    """
    if not recorded:
        yield
        return
    if device.type != "cuda" or Ranks.present().count > 1:
        raise UsageError("training.cannot_record", device=device.type)
    stream = torch.cuda.Stream(device)
    stream.wait_stream(torch.cuda.current_stream(device))
    with torch.cuda.stream(stream):
        yield
    torch.cuda.current_stream(device).wait_stream(stream)
