# The names of __init__.py for type checkers and editors; a test compares the two.

__version__: str
__all__: list[str]

# True where the program itself is checked (pyproject.toml): its modules are below this package, and would all depend on
# each other through it.
CHECKED_FROM_INSIDE: bool

if not CHECKED_FROM_INSIDE:
    from kirigami_studio.api.checked_file import CheckedFile as CheckedFile
    from kirigami_studio.api.checked_file import check as check
    from kirigami_studio.api.design import Cuts as Cuts
    from kirigami_studio.api.design import Design as Design
    from kirigami_studio.api.design import Exported as Exported
    from kirigami_studio.api.design import Pieces as Pieces
    from kirigami_studio.api.design import Sheet as Sheet
    from kirigami_studio.api.design import decode as decode
    from kirigami_studio.api.design import score as score
    from kirigami_studio.api.design import share as share
    from kirigami_studio.api.design import siou as siou
    from kirigami_studio.api.designs import Designs as Designs
    from kirigami_studio.api.designs import design as design
    from kirigami_studio.api.designs import load_project as load_project
    from kirigami_studio.api.designs import machine_names as machine_names
    from kirigami_studio.api.designs import material_names as material_names
    from kirigami_studio.api.designs import preview as preview
    from kirigami_studio.api.parts import ExportedParts as ExportedParts
    from kirigami_studio.api.parts import Parts as Parts
    from kirigami_studio.api.parts import design_parts as design_parts
    from kirigami_studio.api.parts import load_parts as load_parts
    from kirigami_studio.api.simulation import Simulation as Simulation
    from kirigami_studio.api.target import Target as Target
    from kirigami_studio.api.target import load_target as load_target
    from kirigami_studio.api.target import target_names as target_names
    from kirigami_studio.evaluate.feasibility import Feasibility as Feasibility
    from kirigami_studio.evaluate.score import Score as Score
    from kirigami_studio.foundation.errors import KirigamiError as KirigamiError
    from kirigami_studio.pipeline.events import Progress as Progress
    from kirigami_studio.studio.verdict import Verdict as Verdict
