import pytest

from petalfoil import errors
from petalfoil.errors import ConvergenceError, DefinitionError, PackError, PetalfoilError, StoreError, UnitError


def test_the_tree() -> None:
    assert issubclass(UnitError, DefinitionError)
    assert issubclass(PackError, DefinitionError)
    classes = [
        value for value in vars(errors).values() if isinstance(value, type) and value.__module__ == errors.__name__
    ]
    assert len(classes) == 7
    for one in classes:
        assert issubclass(one, PetalfoilError)
        assert one.__name__ in (errors.__doc__ or "")


@pytest.mark.parametrize(
    ("kind", "code"), [(DefinitionError, 2), (UnitError, 2), (StoreError, 2), (ConvergenceError, 3)]
)
def test_exit_codes(kind: type[PetalfoilError], code: int) -> None:
    assert kind("why").exit_code == code


def test_a_definition_error_carries_what_explains_it() -> None:
    error = PackError("petals.count: 1 is too few", key="petals.count", given=1, allowed="at least 2")
    assert (error.key, error.given, error.allowed) == ("petals.count", 1, "at least 2")
    assert str(error) == "petals.count: 1 is too few"
    assert DefinitionError("why").key == ""


def test_a_convergence_error_keeps_its_history() -> None:
    error = ConvergenceError("no", history=[{"step": 1, "residual": 0.5}], advice="try more")
    assert error.history == [{"step": 1, "residual": 0.5}]
    assert error.advice == "try more"
    assert ConvergenceError("no").history == []
