"""A verdict wherever it is shown in brief: icon and colour, pale for an estimate, and badges, the worst first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kirigami_studio.gui.widgets.theme import Palette

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

#: Icon of each level, by its name in JSON, and of what nobody has checked so far.
ICONS = {"ready_to_cut": "check", "cut_with_care": "warning", "will_not_work": "fault", "": "info"}
#: Opacity of the mark of an estimate.
PALE = 0.55
#: Stands before the words of an estimate where there is no room for more.
ABOUT = "\N{ALMOST EQUAL TO} "


def level_of(verdict: Verdict | None) -> str:
    """The level by its name in JSON, "" for what nobody has checked so far."""
    return "" if verdict is None or not verdict.is_checked else verdict.level.value


def colour_of(level: str, palette: Palette) -> str:
    """The colour of a level by its name in JSON, or of the state of an answer by its own."""
    if level in ("ready_to_cut", "good"):
        return palette.good
    if level in ("will_not_work", "bad"):
        return palette.bad
    return palette.warning if level in ("cut_with_care", "care") else palette.muted


#: States of answers, by their names in JSON, from the worst on; what nobody has looked for is not shown.
WORST_FIRST = ("bad", "care", "good")


@dataclass(frozen=True, slots=True)
class Badge:
    """One fact."""

    text: str  #: a few words, after a sign that stands for an estimate
    tip: str  #: whole sentences
    state: str  #: level of the verdict, or state of an answer, by their names in JSON
    is_level: bool = False  #: whether it is the verdict itself, which alone has an icon


def badges_of(verdict: Verdict) -> tuple[Badge, ...]:
    """The level and the answers of a verdict, the worst first; files are no matter of a card."""
    from kirigami_studio.studio.verdict import Question, question_of

    about = ABOUT if verdict.is_estimate and verdict.is_checked else ""
    words = verdict.level_words if verdict.is_checked else verdict.words
    found = [Badge(f"{about}{words}", "\n".join(verdict.lines), level_of(verdict), is_level=True)]
    answers = [answer for answer in verdict.answers if answer.question is not Question.FILES]
    for state in WORST_FIRST:
        for answer in answers:
            if answer.state.value == state:
                closing = answer.question is Question.CLOSES
                tip = [problem.text for problem in verdict.problems if question_of(problem) is answer.question]
                text = closing_text(verdict) if closing else answer.word
                found.append(Badge(text, "\n".join(tip) or verdict.summary, state))
    return tuple(found)


def closing_text(verdict: Verdict) -> str:
    """Whether the sheet closes, in a few words; "" where nobody has looked."""
    from kirigami_studio.studio.verdict import AnswerState, Question

    answer, found = verdict.answer(Question.CLOSES), verdict.as_cut
    if answer.state is AnswerState.OPEN:
        return ""
    return f"{ABOUT}{answer.word}" if found is not None and found.source.value == "estimate" else answer.word
