"""A project of one small design, for tests of what is made of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import new_settings


def square_document(choices: dict[str, Any]) -> Document:
    """A square of 3 x 3 voids, a pinwheel, made as chosen."""
    sheet = Sheet(RatioField(10 ** (0.1 * (-1.0) ** np.add.outer(range(3), range(3)))))
    target = silhouettes.load("square")
    candidate = Candidate(sheet, evaluate(deploy(sheet), target), 0, 0)
    return Document(target, DesignSettings(), (candidate,), 0, fabrication=new_settings(choices))
