"""Knows what the table and the wizard say of who takes part."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from woz_tui.config.experiment import Experiment
from woz_tui.features.people.history import PeopleHistory, known_fields
from woz_tui.features.people.kinds import AskDescribe, ParticipantDescribed
from woz_tui.features.people.section import CODE, PEOPLE
from woz_tui.features.slots.slot_value import SlotValueError
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.participant_identity import check_participant
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature
from woz_tui.session.variables import VariableValues

#: Where it may be from, beside who asks.
TABLE = "table"


class PeopleInSession(SessionFeature):
    """Fields of who takes part, as variables of what is said to them."""

    requests = (AskDescribe,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._known = PEOPLE.of(session.experiment)

    def idle(self) -> bool:
        return not self._known.fields

    def begin(self) -> None:
        self._look_up()

    def adopt(self, experiment: Experiment) -> None:
        self._known = PEOPLE.of(experiment)
        self._look_up()

    def values(self) -> VariableValues:
        told = known_fields(self.session.state)
        names = {f"{CODE}.{name}": name for name in self._known.fields}
        described = self.session.state.history(PeopleHistory).described
        said = described.get(self.session.identity.participant)
        tells = said.tells if said is not None else ("identity",)
        return VariableValues(
            {variable: told[name] for variable, name in names.items() if name in told},
            why=dict.fromkeys(
                names,
                Sentence(
                    "people.unknown",
                    "nothing is known of it; enter it with the participant's code",
                ),
            ),
            tells=dict.fromkeys(names, tells),
        )

    def carry_out(self, request: AskDescribe, client: Client) -> str:
        check_participant(request.participant, self.session.experiment.participant_pattern)
        fields = {**self._fields_of(request.participant)}
        for name, text in request.fields.items():
            if name not in self._known.fields:
                raise RequestError(
                    Sentence(
                        "people.no_field",
                        "participants have no field {name!r}",
                        name=name,
                    ),
                    conditions=[*self._known.fields],
                )
            try:
                fields[name] = self._known.checked(name, text)
            except SlotValueError as error:
                raise RequestError(f"{name} {error}") from error
        source = "wizard" if client.role == "wizard" else "program"
        self._publish(request.participant, fields, source, client.tells)
        return ""

    def _fields_of(self, participant: str) -> Mapping[str, str]:
        said = self.session.state.history(PeopleHistory).described.get(participant)
        return said.fields if said is not None else self._known.rows.get(participant, {})

    def _changed(self, message: m.SessionChanged) -> None:
        if message.participant is not None:
            self._look_up()

    def _look_up(self) -> None:
        """The table says who takes part; what the wizard has said goes before it."""
        code = self.session.identity.participant
        row = self._known.rows.get(code)
        said = self.session.state.history(PeopleHistory).described.get(code)
        if code and row and (said is None or (said.source == TABLE and said.fields != row)):
            self._publish(code, row, TABLE)

    def _publish(
        self,
        participant: str,
        fields: Mapping[str, str],
        source: str,
        tells: tuple[str, ...] = (),
    ) -> None:
        known = {name: value for name, value in fields.items() if value}
        self.session.hub.publish(
            ParticipantDescribed(
                participant=participant,
                fields=known,
                source=source,
                tells=("identity", *tells),
            )
        )
        asyncio.get_running_loop().call_soon(self.session.values_changed)

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {
        m.SessionChanged: _changed
    }
