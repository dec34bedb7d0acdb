"""Bundle trained weights as variants of the generator: ``python packaging/bundle_models.py NAME=WEIGHTS ...``.

``WEIGHTS`` are those of a run of ``train prior`` or ``train grpo``.  They are written into ``resources/models``, and
how they were trained goes into the manifest there.  The paper's own way is bundled by::

    python packaging/bundle_models.py paper=RUN/prior.safetensors paper-accuracy=RUN/grpo-accuracy.safetensors ...
"""

from __future__ import annotations

import sys
from pathlib import Path

from kirigami_studio.generator.weights import model_folder
from kirigami_studio.lab.trained_weights import load_weights, store_model, variants_about


def bundle(name: str, weights: Path) -> Path:
    """Store the weights of a training run as the bundled variant ``name``.

    Raises
    ------
    ModelError
        They cannot be read.
    """
    model = load_weights(weights)
    return store_model(name, model.network, model_folder(), variants_about(weights.parent)[model.variant])


if __name__ == "__main__":
    pairs = [word.partition("=") for word in sys.argv[1:]]
    if not pairs or not all(name and weights for name, _, weights in pairs):
        sys.exit("usage: python packaging/bundle_models.py NAME=WEIGHTS ...")
    for name, _, weights in pairs:
        print(bundle(name, Path(weights)))
