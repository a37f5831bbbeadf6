import math
import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from petalfoil.errors import PetalfoilError, UnitError, UsageError
from petalfoil.units import parse_pair, parse_quantity, parse_range
from petalfoil.units.reading import is_bare, note_on_bare, shown


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("25 um", "m", 25e-6),
        ("25um", "m", 2.5e-05),
        ("25 µm", "m", 2.5e-05),
        ("25 μm", "m", 2.5e-05),
        ("0.176 mm", "m", 1.76e-4),
        (" 1e-3m ", "m", 1e-3),
        ("1 in", "m", 0.0254),
        ("-100 um", "m", -1e-4),
        ("−100 um", "m", -1e-4),
        (".5 mm", "m", 5e-4),
        ("+5. mm", "m", 5e-3),
        ("0.025", "m", 0.025),
        ("200 GPa", "Pa", 2e11),
        ("1 bar", "Pa", 1e5),
        ("18.5 uPa*s", "Pa*s", 1.85e-05),
        ("18.5 uPa s", "Pa*s", 1.85e-05),
        ("1.85e-5 kg/(m s)", "Pa*s", 1.85e-05),
        ("1.85e-5 kg m⁻¹ s^-1", "Pa*s", 1.85e-05),
        ("8000 rad/s", "rad/s", 8000.0),
        ("8000 1/s", "rad/s", 8000.0),
        ("8000 s⁻¹", "rad/s", 8000.0),
        ("20 degC", "K", 293.15),
        ("20 °C", "K", 293.15),
        ("293.15 K", "K", 293.15),
        ("287.05 J/(kg*K)", "J/(kg*K)", 287.05),
        ("287.05 J/kg/K", "J/(kg*K)", 287.05),
        ("1 kgf", "N", 9.80665),
        ("5 %", "1", 0.05),
        ("20 mil", "m", 20 * 2.54e-5),
        ("2 mils", "m", 5.08e-5),
        ("2 lbm", "kg", 0.90718474),
        ("200 GPA", "Pa", 2e11),
        ("0.3", "1", 0.3),
    ],
)
def test_a_text_becomes_the_float_nearest_to_it(text: str, unit: str, expected: float) -> None:
    assert parse_quantity(text, unit) == expected


@pytest.mark.parametrize("text", ["60000 rpm", "60000 rev/min", "1000 rps", "1000 turn/s", "360000 deg/s"])
def test_turns_are_two_pi(text: str) -> None:
    assert parse_quantity(text, "rad/s") == pytest.approx(60000 * 2 * math.pi / 60, rel=1e-15)


@pytest.mark.parametrize("text", ["30 krpm", "30 KRPM", "30000 RPM", "500 rps"])
def test_speeds_as_engineers_write_them(text: str) -> None:
    assert parse_quantity(text, "rad/s") == pytest.approx(1000.0 * math.pi, rel=1e-15)


@pytest.mark.parametrize(("text", "psi"), [("14.7 psia", 14.7), ("3 ksi", 3e3), ("30 Msi", 30e6), ("2 kpsi", 2e3)])
def test_pounds_per_square_inch(text: str, psi: float) -> None:
    assert parse_quantity(text, "Pa") == pytest.approx(psi * 0.45359237 * 9.80665 / 0.0254**2, rel=1e-14)


@pytest.mark.parametrize("text", ["100 Hz", "0.1 kHz", "6000 rpm", "100 rps", "628.3185307179587 rad/s"])
def test_whirl_frequencies_are_read_in_hertz_too(text: str) -> None:
    assert parse_quantity(text, "rad/s", whirl=True) == pytest.approx(200.0 * math.pi, rel=1e-15)
    assert parse_range(f"{text}, {text}", "rad/s", whirl=True) == [parse_quantity(text, "rad/s", whirl=True)] * 2
    assert parse_range(f"0 : {text} : 3", "rad/s", whirl=True)[1] == pytest.approx(100.0 * math.pi, rel=1e-15)


def test_what_has_no_unit_is_bare() -> None:
    assert all(is_bare(value) for value in (5, "5", " −1e-3 "))
    assert not any(is_bare(value) for value in ("5 mm", "5 %", "five"))


@pytest.mark.parametrize(
    ("text", "unit", "note"),
    [
        ("5", "m", "'5' has no unit and is read in m; write the unit, such as '25 um'"),
        ("0 : 100 : 11", "m", "'0 : 100 : 11' has no unit and is read in m; write the unit, such as '25 um'"),
        ("45", "rad", "'45' has no unit and is read in rad (2578.3°); write the unit, such as '45 deg'"),
        ("0, -100 um", "m", ""),
        ("0", "m", ""),
        ("0.01", "1", ""),
        ("balance", "m", ""),
    ],
)
def test_bare_numbers_are_told_with_their_unit(text: str, unit: str, note: str) -> None:
    assert note_on_bare(text, unit) == note


def test_bare_whirl_frequencies_are_told_in_hertz() -> None:
    noted = note_on_bare("1000, 2000", "rad/s", whirl=True)
    assert noted == "'1000, 2000' has no unit and is read in rad/s (159.15 Hz); write the unit, such as '600 Hz'"


def test_angles() -> None:
    assert parse_quantity("-90 deg", "rad") == -math.pi / 2
    assert parse_quantity("45°", "rad") == math.pi / 4
    assert parse_quantity("0.5 rad", "rad") == 0.5
    assert parse_quantity("0.5", "rad") == 0.5


@pytest.mark.parametrize("value", [0.025, 3, np.float64(0.1), np.float32(0.5), np.int64(7)])
def test_bare_numbers_are_si(value: float) -> None:
    parsed = parse_quantity(value, "m")
    assert parsed == float(value)
    assert type(parsed) is float


@pytest.mark.parametrize(
    "value",
    [True, False, None, [1.0], {"value": 1}, 1j, b"1 m", math.nan, math.inf, -math.inf, 10**400, np.array([1.0, 2.0])],
)
def test_no_quantity_at_all(value: object) -> None:
    with pytest.raises(UnitError, match=r"expected a length, such as '25 um', or a bare number in m"):
        parse_quantity(value, "m")


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("", "m", "does not begin with a number"),
        ("um", "m", "does not begin with a number"),
        ("nan", "m", "does not begin with a number"),
        ("inf m", "m", "does not begin with a number"),
        ("1e400", "m", "is not finite"),
        ("1e400 m", "m", "cannot be converted"),
        ("1e9999 m", "m", "'9999'"),
        ("25 parsnips", "m", "unknown unit 'parsnips'"),
        ("25 kg", "m", "measures something else (mass)"),
        ("5 g*mm", "m", "an unbalance is divided by the mass of the rotor, such as 5 g mm / 2 kg = 2.5 um"),
        ("25 m^2", "m", "measures something else (length^2)"),
        ("1 degC/m", "K", "something else"),
        ("3 dB", "m", "something else"),
        ("100 Hz", "rad/s", "ambiguous: for turns write '6000 rpm', for radians '100 rad/s'"),
        ("1.5 kHz", "rad/s", "ambiguous: for turns write '90000 rpm', for radians '1500 rad/s'"),
        ("60 1/min", "rad/s", "ambiguous: for turns write '60 rpm', for radians '1 rad/s'"),
        ("200 gpa", "Pa", "unknown unit 'gpa' (did you mean 'GPa'?)"),
        ("30 KRpm", "rad/s", "unknown unit 'KRpm' (did you mean 'krpm'?)"),
        ("2 psig", "Pa", "is a gauge pressure (psig): write the absolute one"),
        ("1 mil", "rad", "measures something else (length)"),
        ("30 deg", "1", "is an angle"),
        ("1 m/", "m", "lacks a unit at its end"),
        ("1 (m", "m", "a bracket that is not closed"),
        ("1 m)", "m", "')'"),
        ("1 m**m", "m", "the power 'm'"),
        ("1 N/mm2", "Pa", "has '2' where its unit should end; a power is written '^2'"),
        ("1 m^99", "m", "the power '99'"),
        ("9**9**9**9 m", "m", "'**'"),
        ("25 um + 3 um", "m", "'+'"),
        ("1,5 mm", "m", "has a decimal comma: write a decimal point, '1.5 mm'"),
        ("-0,1 mm", "m", "write a decimal point, '-0.1 mm'"),
        ("1 __import__('os').abort()", "m", "'_'"),
        ("1 " + "m " * 100, "m", "too long"),
    ],
)
def test_the_message_says_what_is_wrong(text: str, unit: str, reason: str) -> None:
    with pytest.raises(UnitError) as caught:
        parse_quantity(text, unit)
    assert reason in str(caught.value)
    assert "expected a" in str(caught.value)
    assert caught.value.given == text
    assert "such as" in caught.value.allowed


UNIT_LIKE = st.text(alphabet="mskgPauNrdegCKJWrpbar0123456789.eE+-*/^() ·°µ²⁻¹%", max_size=40)


@given(st.one_of(st.text(max_size=60), UNIT_LIKE.map("1 ".__add__), UNIT_LIKE))
@example("1 ((((((((((((((((((((((((((((((((((((((m")
@example("1 Ym^9 Ym^9 Ym^9 Ym^9 Ym^9 Ym^9 Ym^9 Ym^9")
@example("1 m\x00")
@example("1 ٣")
@example("1 m^\ud800")
def test_junk_gives_a_finite_float_or_a_unit_error(text: str) -> None:
    for unit in ("m", "rad/s", "K", "1"):
        try:
            number = parse_quantity(text, unit)
        except UnitError:
            continue
        assert math.isfinite(number)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_survive_as_text(value: float) -> None:
    assert parse_quantity(repr(value), "m") == value
    assert parse_quantity(f"{value!r} m", "m") == value


def test_a_pair() -> None:
    assert parse_pair("0 um, -100 um", "m") == (0.0, -1e-4)
    assert parse_pair("1e-6,2e-6", "m") == (1e-6, 2e-6)


@pytest.mark.parametrize(
    ("unit", "typed"),
    [
        (
            "K",
            {
                "degC": "C c °_C ºC oC ℃ deg_C degrees_C deg ° Celsius",
                "degF": "F f ℉ deg_f Fahrenheit",
                "K": "k Kelvin",
            },
        ),
        ("m", {"um": "u uM UM mic", "mm": "mM MM", "nm": "n NM", "m": "M", "in": 'IN "'}),
        ("kg", {"g": "G", "kg": "k K KG Kg kgs kilo", "t": "T", "lb": "LB"}),
        ("s", {"s": "S", "ms": "mS MS", "us": "uS", "min": "m Min", "h": "H"}),
        (
            "Pa",
            {
                "bar": "B b Bar",
                "Pa": "P PA pa",
                "kPa": "k KPA kpa",
                "MPa": "M mpa",
                "GPa": "G gpa",
                "kgf/cm^2": "kg/cm^2",
            },
        ),
        ("Pa*s", {"cP": "cp CP", "uPa s": "uPas", "mPa s": "mPas", "Pa s": "Pas"}),
        ("N", {"N": "n", "kN": "kn KN", "kgf": "kg", "lbf": "lb LBF", "gf": "g"}),
        ("rad/s", {"rpm": "Rpm r/min U/min", "rad/s": "rad RAD/S"}),
        ("rad", {"deg": "d Deg", "rad": "r"}),
        ("J/(kg*K)", {"J/(kg K)": "J/kgK J/kg_K"}),
        ("W/K", {"W/K": "W/C"}),
        ("1/K", {"1/K": "1/C"}),
    ],
)
def test_units_that_people_type(unit: str, typed: dict[str, str]) -> None:
    """Each is refused, and the unit that is meant is told and can be read."""
    for meant, texts in typed.items():
        assert parse_quantity(f"1 {meant}", unit) > 0.0
        for text in texts.split():
            with pytest.raises(UnitError, match=rf"did you mean '{re.escape(meant)}'\?"):
                parse_quantity(f"1 {text.replace('_', ' ')}", unit)


def test_what_measures_something_else_has_no_near_unit() -> None:
    """A near name that measures something else is none."""
    for text, unit in (("5 kg", "m"), ("2 m", "kg"), ("2 mic", "kg"), ("80 furlongs", "K")):
        with pytest.raises(UnitError) as caught:
            parse_quantity(text, unit)
        assert "did you mean" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12e-6 1/degC", "1/K", 12e-6),
        ("9e-6 1/degF", "1/K", 16.2e-6),
        ("2 W/°C", "W/K", 2.0),
        ("287 J/(kg*degC)", "J/(kg*K)", 287.0),
        ("20 degC", "K", 293.15),
    ],
)
def test_degrees_within_a_unit_are_differences(text: str, unit: str, value: float) -> None:
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["0,1 mm", "-0,1mm", "1 um,5,2 um"])
def test_a_decimal_comma_is_no_list(text: str) -> None:
    """`0,1 mm` would be the pair of 0 m and 1 mm, ten times as far as was meant."""
    for parse in (parse_pair, parse_range):
        with pytest.raises(UsageError, match="has a decimal comma: write a decimal point, '"):
            parse(text, "m")


@pytest.mark.parametrize("text", ["20000, 30000 rpm", "20000 rpm, 30000", "20000, 30000, 40000 rpm", "−20000, 3 rpm"])
def test_a_unit_with_some_numbers_of_a_list_is_refused(text: str) -> None:
    """It may be meant for all: 20000 would else be rad/s."""
    with pytest.raises(UsageError, match=r"none with '.?[23]0000'") as refused:
        parse_range(text, "rad/s")
    assert "would be read in rad/s; write a unit with each quantity" in str(refused.value)


def test_a_unit_with_some_numbers_of_a_pair_or_a_range_is_refused() -> None:
    with pytest.raises(UsageError, match="none with '20000'"):
        parse_range("20000 : 60000 rpm : 5", "rad/s")
    with pytest.raises(UsageError, match="none with '10'"):
        parse_pair("10, -20 N", "N")
    assert parse_pair("0, -20 N", "N") == (0.0, -20.0)
    assert parse_range("0 : 4 um : 3", "m") == pytest.approx([0.0, 2e-6, 4e-6])
    assert parse_range("10, 20", "rad/s") == [10.0, 20.0]
    assert parse_range("0.1, 20 %", "1") == [0.1, 0.2]


def test_a_list_without_blanks_is_a_list() -> None:
    assert parse_pair("1 um,2 um", "m") == (1e-6, 2e-6)
    assert parse_pair("0,-1 mm", "m") == (0.0, -1e-3)
    assert parse_pair("0, 1 mm", "m") == (0.0, 1e-3)


@pytest.mark.parametrize("text", ["", "1 um", "1 um, 2 um, 3 um"])
def test_no_pair(text: str) -> None:
    with pytest.raises(UsageError, match="is not a pair"):
        parse_pair(text, "m")


def test_a_pair_with_a_wrong_unit() -> None:
    with pytest.raises(UnitError, match="mass"):
        parse_pair("1 um, 2 kg", "m")


def test_a_range_includes_both_ends() -> None:
    points = parse_range("0 um : 280 um : 15", "m")
    assert points[0] == 0.0
    assert points[-1] == 2.8e-4
    np.testing.assert_allclose(points, np.linspace(0.0, 2.8e-4, 15), rtol=1e-14, atol=0.0)


def test_a_list_and_a_single_quantity_are_ranges_too() -> None:
    assert parse_range("0 um, 50 um, 100 um", "m") == [0.0, 5e-5, 1e-4]
    assert parse_range("100 um", "m") == [1e-4]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("0 um : 1 um", "start : stop : count"),
        ("0 um : 1 um : 3 : 4", "start : stop : count"),
        ("0 um : 1 um : 1", "count"),
        ("0 um : 1 um : 2.5", "count"),
        ("0 um : 1 um : -3", "count"),
        ("0 um : 1 um : many", "count"),
        ("0 um : 1 um : 99999999999", "count"),
        ("0 kg : 1 um : 3", "mass"),
        ("", "does not begin with a number"),
        ("1 um,,2 um", "does not begin with a number"),
    ],
)
def test_no_range(text: str, reason: str) -> None:
    with pytest.raises((UsageError, UnitError)) as caught:
        parse_range(text, "m")
    assert reason in str(caught.value)


@given(st.text(alphabet="0123456789. um:,-e", max_size=30))
def test_junk_ranges_raise_nothing_else(text: str) -> None:
    for parse in (parse_range, parse_pair):
        try:
            points = parse(text, "m")
        except PetalfoilError:
            continue
        assert all(math.isfinite(point) for point in points)


def test_long_values_are_cut_in_messages() -> None:
    assert shown("x" * 1000) == repr("x" * 60 + "…")
    assert len(shown(list(range(1000)))) == 61
    assert shown(10**5000) == "a value of type int"
    nested: list[object] = []
    for _ in range(100_000):
        nested = [nested]
    assert shown(nested) == "a value of type list"


@pytest.mark.parametrize("text", ["60,000 rpm", "1,234,567 Pa"])
def test_a_comma_before_three_digits_may_mark_thousands(text: str) -> None:
    """60.000 rpm, the decimal reading alone, would be sixty revolutions per minute."""
    unit = "rad/s" if "rpm" in text else "Pa"
    with pytest.raises(UnitError, match=f"write '{text.replace(',', '')}' if it marks thousands"):
        parse_quantity(text, unit)


def test_pressures_are_absolute_without_a_word() -> None:
    with pytest.raises(UnitError, match="pressures are absolute"):
        parse_quantity("1 bar abs", "Pa")
