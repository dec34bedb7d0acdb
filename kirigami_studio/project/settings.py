"""Names of the settings that stood here before they had a floor of their own, below project and pipeline."""

from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, material_for, stored_material, with_choices

__all__ = ["DesignSettings", "FabricationSettings", "material_for", "stored_material", "with_choices"]
