"""Friction and normal laws by name, with their constants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import ConfigDict, Discriminator, Tag, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.tables import SceneTable

if TYPE_CHECKING:
    from wheelrail.contact.laws.friction import FrictionLaw
    from wheelrail.contact.laws.normal import NormalLaw


class LawTable(SceneTable):
    """A law by name, with its constants as further keys."""

    model_config = ConfigDict(strict=True, extra="allow", frozen=True)

    @property
    def constants(self) -> dict[str, Any]:
        return dict(self.model_extra or {})

    @property
    def instance(self) -> object:
        """The law; raises InvalidLaw."""
        raise NotImplementedError

    @model_validator(mode="after")
    def _valid(self) -> LawTable:
        from wheelrail.contact.laws.registry import InvalidLaw

        try:
            _ = self.instance
        except InvalidLaw as error:
            raise q.reject(error.allowed, error.key) from None
        return self


class FrictionTable(LawTable):
    """A friction law: "coulomb" (mu), "falling" (mu, share, rate), "stribeck" (static, kinetic, speed), "polach-dry" or
    "polach-wet" (Polach's constants), or a user's own, "module:Class", which the command line must allow.
    """

    law: str

    @property
    def instance(self) -> FrictionLaw:
        from wheelrail.contact.laws.registry import friction_law

        return friction_law(self.law, self.constants)


def _kind(friction: Any) -> str:
    return "table[law]" if isinstance(friction, Mapping | FrictionTable) else "number"


# the kind of the value decides which errors are reported
FrictionKey = Annotated[
    Annotated[q.Friction, Tag("number")] | Annotated[FrictionTable, Tag("table[law]")], Discriminator(_kind)
]


class NormalTable(LawTable):
    """A normal law: "penalty" (stiffness), "power" (stiffness, exponent), or a user's own, "module:Class"."""

    law: str

    @property
    def instance(self) -> NormalLaw:
        from wheelrail.contact.laws.registry import normal_law

        return normal_law(self.law, self.constants)
