"""Research beside the product: experiments, training, judges, pictures of the program.

``problem`` gives targets, a simulator and a score to other generators; ``baselines`` are the solvers and generators
that the paper compares with; ``training`` makes weights; ``benchmark`` makes figures and tables; ``demonstrations``
play the window for pictures; ``cli`` runs all of them.  The product finds their commands by name and never imports
them; a frozen program has none of them.
"""

from kirigami_studio.foundation.sentences import SENTENCES
from kirigami_studio.lab import sentences

SENTENCES.update(sentences.SENTENCES)
