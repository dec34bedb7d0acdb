"""Numbers of the paper that more than one package needs (Yazdani, Shalileh, Shahriari)."""

from __future__ import annotations

#: Pixels along each side of the masks that silhouettes are compared on.
MASK_SIZE = 128
#: Fields are sampled and fitted within x = 10^z, z in [-1, 1]: ratios from 0.1 to 10.
LOG_RATIO_LIMIT = 1.0
