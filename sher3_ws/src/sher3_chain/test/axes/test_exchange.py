"""Shapes searched again beside the other causes, which keep their order."""

from sher3_chain.axes.evidence import gather_axis
from sher3_chain.axes.machine import facts_of
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.exchange import exchanged
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import fit
from sher3_effects import pages
from slides import axis_of, driven, run_of


def test_a_shape_is_searched_again_beside_the_others():
    """Friction and viscosity with the friction's displacement far off: it is found again, and the order stays."""
    evidence = gather_axis([run_of(driven(8.0, coulomb=5.0, viscous=40.0))], axis_of(), False)
    effects = {e.id: e for e in pages("axis", facts_of(evidence.axis))}
    candidates = Candidates(evidence, list(effects.values()))
    shapes = effects["coulomb_friction"].shapes(evidence.views, "slide")
    worst = fit(
        evidence.data,
        [
            candidates.term(effects["coulomb_friction"], "slide", {"displacement": 50.0 * shapes[-1]["displacement"]}),
            candidates.term(effects["viscous_friction"], "slide", {}),
        ],
    )
    found = exchanged(candidates, Attribution(worst, ((), ()), (0.0, 0.0)))
    assert found.total < worst.total
    assert [t.key for t in found.terms] == [t.key for t in worst.terms]
    assert found.terms[0].shape in shapes
