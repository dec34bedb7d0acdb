"""What PyInstaller takes of torch: the modules that an import loads and those they name, and its shared libraries.

This takes the place of the general hook, which adds every module and the source of each for TorchScript; this program
compiles and scripts nothing.
"""

from pathlib import Path

from PyInstaller import isolated
from PyInstaller.utils.hooks import PY_DYLIB_PATTERNS, collect_dynamic_libs, get_package_paths


@isolated.decorate
def loaded() -> list[str]:
    """Modules that torch has loaded once it is imported, some of them by name."""
    import sys

    import torch  # noqa: F401

    return [name for name in sys.modules if name.partition(".")[0] in ("torch", "torchgen")]


#: These read their own source: the comments beside their settings mean something to them.
CONFIGURATIONS = (
    "torch._export.config",
    "torch._functorch.config",
    "torch.compiler.config",
    "torch.distributed.config",
    "torch.fx.experimental._config",
    "torch.utils.serialization.config",
)
module_collection_mode = {"torch": "pyz"} | dict.fromkeys(CONFIGURATIONS, "pyz+py")
hiddenimports = loaded()
binaries = collect_dynamic_libs("torch", search_patterns=[*PY_DYLIB_PATTERNS, "*.so.*"])
# The import looks whether this one is there.
manager = Path(get_package_paths("torch")[1]) / "bin" / "torch_shm_manager"
binaries += [(str(manager), "torch/bin")] if manager.is_file() else []
# Links from the top folder would have torch look for its libraries there.
bindepend_symlink_suppression = ["**/torch/lib/*.so*"]
