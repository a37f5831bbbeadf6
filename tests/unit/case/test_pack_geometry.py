import math

import pytest

from petalfoil.case import Case, pack_of
from petalfoil.errors import PackError
from tests.cases import case


def test_the_paper_s_pack() -> None:
    paper = case("paper_n8")
    assert paper.petals is not None
    pack = pack_of(paper.bearing, paper.petals)
    assert paper.pack == pack
    assert pack.metric_radius == pytest.approx(25.912e-3, rel=1e-14)
    assert pack.petal_angle == pytest.approx(45 / 25.912, rel=1e-14)
    assert pack.pitch == pytest.approx(math.pi / 4, rel=1e-15)
    assert pack.overlap == pytest.approx(45 / 25.912 / (math.pi / 4), rel=1e-14)
    assert pack.covered_angle == pytest.approx(45 / 25.912 - math.pi / 4, rel=1e-14)
    assert pack.layers == 3


@pytest.mark.parametrize(("name", "layers"), [("paper_n6", 2), ("paper_n8", 3), ("paper_n10", 3), ("rig", 2)])
def test_layers(name: str, layers: int) -> None:
    pack = case(name).pack
    assert pack is not None
    assert pack.layers == layers
    assert layers - 1 <= pack.overlap < layers


def test_clearances() -> None:
    paper = case("paper_n8", **{"operation.eccentricity": (3e-5, -4e-5)})
    assert paper.radial_clearance == pytest.approx(1e-3 - 5e-5, rel=1e-12)
    assert paper.pack_clearance == pytest.approx(1e-3 - 5e-5 - 3 * 0.176e-3 - 1e-6, rel=1e-12)
    assert case("plain_journal").pack_clearance == pytest.approx(14e-6, rel=1e-9)


def test_a_pack_is_refused_exactly_where_it_no_longer_fits() -> None:
    paper = case("paper_n8", **{"operation.eccentricity": (0.0, 0.0)})
    left = paper.pack_clearance
    fits = paper.replace(**{"operation.eccentricity": (0.0, -0.999999 * left)})
    assert fits.pack_clearance > 0.0
    with pytest.raises(PackError, match="too much") as caught:
        paper.replace(**{"operation.eccentricity": (0.0, -(left + 2e-6))})
    assert caught.value.key == "operation.eccentricity"
    assert "2 µm too much" in str(caught.value)


def test_too_thick_for_the_clearance_is_no_matter_of_the_journal() -> None:
    with pytest.raises(PackError, match="123 µm too much") as caught:
        case("paper_n8", **{"operation.eccentricity": (0, 0), "petals.thickness": "0.374 mm"})
    assert caught.value.key == "petals"


def test_overlap_is_refused_exactly_at_one_pitch() -> None:
    paper = case("paper_n8")
    assert paper.pack is not None
    pitch_length = paper.pack.metric_radius * paper.pack.pitch
    longer = paper.replace(**{"petals.arc_length": pitch_length * 1.001})
    assert longer.pack is not None
    assert longer.pack.overlap == pytest.approx(1.001, rel=1e-12)
    for arc_length in (pitch_length, pitch_length * (1 + 1e-14)):
        with pytest.raises(PackError, match="do not overlap"):
            paper.replace(**{"petals.arc_length": arc_length})
    with pytest.raises(PackError, match="1 mm short"):
        paper.replace(**{"petals.arc_length": pitch_length - 1e-3})


def test_the_coating_adds_to_the_thickness_but_not_to_the_stiffness() -> None:
    bare = case("paper_n8").petals
    coated = case("paper_n8", **{"petals.coating": "20 um"}).petals
    assert bare is not None
    assert coated is not None
    assert coated.total_thickness == pytest.approx(0.196e-3, rel=1e-14)
    assert coated.bending_stiffness == bare.bending_stiffness
    assert bare.bending_stiffness == pytest.approx(2e11 * 0.176e-3**3 / (12 * 0.91), rel=1e-14)


def test_several_problems_come_in_one_message() -> None:
    with pytest.raises(PackError) as caught:
        case("paper_n8", **{"petals.count": 32, "petals.bend_radius": "20 mm"})
    message = str(caught.value)
    assert "2 problems" in message
    assert "9 layers of 176 µm and the contact film thickness 1 µm need 1.585 mm" in message
    assert "petals.bend_radius: a chordal petal" in message


def test_a_plain_bearing_has_no_pack() -> None:
    plain = case("plain_journal")
    assert isinstance(plain, Case)
    assert plain.pack is None
