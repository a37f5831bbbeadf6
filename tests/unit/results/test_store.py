from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from petalfoil.errors import StoreError
from petalfoil.results.dataset import curve_dataset, to_dataset
from petalfoil.results.store import load, save
from tests.unit.results import factory

DATASETS = {
    "solve": to_dataset(factory.solved(nz=5)),
    "plain": to_dataset(factory.plain()),
    "failed": to_dataset(factory.failed()),
    "check": to_dataset(factory.checked()),
    "curve": curve_dataset(factory.curve()),
    "static": curve_dataset([factory.at_rest(e) for e in (0.0, 1e-4)], analysis="static"),
}


@pytest.mark.parametrize("name", DATASETS)
def test_the_round_trip_is_exact(name: str, tmp_path: Path) -> None:
    ds = DATASETS[name]
    save(ds, tmp_path / "result.nc")
    back = load(tmp_path / "result.nc")
    assert back.identical(ds)
    for variable in ds.variables:
        assert back[variable].dtype == ds[variable].dtype
        assert back[variable].values.tobytes() == ds[variable].values.tobytes()
    assert back.attrs == ds.attrs
    save(back, tmp_path / "again.nc")
    assert load(tmp_path / "again.nc").identical(ds)


def test_text_beyond_ascii_and_empty_text_survive(tmp_path: Path) -> None:
    ds = to_dataset(factory.solved())
    ds.attrs |= {"title": "", "case": 'title = "µ, ω, \\u4e2d"\n# Größe'}
    ds["status"] = ((), np.array("", dtype=np.str_))
    save(ds, tmp_path / "result.nc")
    back = load(tmp_path / "result.nc")
    assert back.attrs == ds.attrs
    assert back["status"].item() == ""


def test_the_file_explains_itself_to_other_readers(tmp_path: Path) -> None:
    save(DATASETS["curve"], tmp_path / "result.nc")
    with netCDF4.Dataset(tmp_path / "result.nc") as raw:
        assert raw["stable"].dtype == np.int8
        assert raw["stable"].flag_values.tolist() == [0, 1]
        assert raw["stable"].flag_meanings == "false true"
        assert raw["pressure"].units == "Pa"
        assert "_FillValue" not in raw["pressure"].ncattrs()
        assert raw.title == "Paper, flat study, 8 petals"


def test_a_failing_write_leaves_the_former_file_and_no_litter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "result.nc"
    save(DATASETS["solve"], target)
    before = target.read_bytes()

    def half_written(self: xr.Dataset, path: Path, **_: object) -> None:
        Path(path).write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", half_written)
    with pytest.raises(StoreError, match=r"cannot write .*no space left"):
        save(DATASETS["curve"], target)
    assert target.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["result.nc"]


def test_a_file_replaces_the_former_one(tmp_path: Path) -> None:
    target = tmp_path / "result.nc"
    save(DATASETS["solve"], target)
    assert load(target).attrs["analysis"] == "solve"
    save(DATASETS["curve"], target)
    assert load(target).attrs["analysis"] == "curve"


def test_a_folder_that_is_not_there_is_a_store_error(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="cannot write"):
        save(DATASETS["solve"], tmp_path / "nowhere" / "result.nc")


def test_absent_files_and_folders_are_store_errors(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="there is no such file"):
        load(tmp_path / "absent.nc")
    with pytest.raises(StoreError, match="is a folder; expected a file"):
        load(tmp_path)


@pytest.mark.parametrize(
    "content", [b"", b"not a NetCDF file", b"\x89HDF\r\n\x1a\n" + bytes(200), b"CDF\x01" + bytes(10)]
)
def test_junk_is_a_store_error(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "junk.nc").write_bytes(content)
    with pytest.raises(StoreError, match=r"junk\.nc"):
        load(tmp_path / "junk.nc")


def test_a_truncated_file_is_a_store_error(tmp_path: Path) -> None:
    save(DATASETS["curve"], tmp_path / "result.nc")
    whole = (tmp_path / "result.nc").read_bytes()
    (tmp_path / "result.nc").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(StoreError, match=r"result\.nc"):
        load(tmp_path / "result.nc")


def test_a_netcdf_file_of_someone_else_is_a_store_error(tmp_path: Path) -> None:
    xr.Dataset({"t": ("x", [1.0, 2.0])}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(StoreError, match="not written by petalfoil"):
        load(tmp_path / "other.nc")


def test_a_file_that_others_copied_keeps_its_data_checksum(tmp_path: Path) -> None:
    save(DATASETS["solve"], tmp_path / "result.nc")
    xr.load_dataset(tmp_path / "result.nc").to_netcdf(tmp_path / "copy.nc")
    assert load(tmp_path / "copy.nc").identical(DATASETS["solve"])


def test_a_number_changed_by_hand_is_refused(tmp_path: Path) -> None:
    save(DATASETS["solve"], tmp_path / "result.nc")
    changed = xr.load_dataset(tmp_path / "result.nc")
    changed["bearing_force"] = changed["bearing_force"] + 8.0
    changed.to_netcdf(tmp_path / "changed.nc")
    with pytest.raises(StoreError, match="do not match their checksum"):
        load(tmp_path / "changed.nc")
    del changed.attrs["petalfoil_digest"]
    changed.to_netcdf(tmp_path / "bare.nc")
    with pytest.raises(StoreError, match="do not match their checksum"):
        load(tmp_path / "bare.nc")


def flipped(whole: bytes, rng: np.random.Generator) -> bytes:
    place, bit = int(rng.integers(len(whole))), int(rng.integers(8))
    return whole[:place] + bytes([whole[place] ^ (1 << bit)]) + whole[place + 1 :]


@pytest.mark.parametrize("count", [100, pytest.param(2000, marks=pytest.mark.slow)])
def test_a_flipped_bit_is_harmless_or_refused(count: int, tmp_path: Path) -> None:
    rng, file = np.random.default_rng(7), tmp_path / "result.nc"
    for name in ("solve", "curve"):
        save(DATASETS[name], file)
        whole = file.read_bytes()
        for _ in range(count // 2):
            file.write_bytes(flipped(whole, rng))
            try:
                back = load(file)
            except StoreError:
                continue
            assert back.identical(DATASETS[name])


def test_a_symbolic_link_stays_a_link(tmp_path: Path) -> None:
    target, link = tmp_path / "disk" / "result.nc", tmp_path / "link.nc"
    target.parent.mkdir()
    save(DATASETS["curve"], target)
    link.symlink_to(target)
    save(DATASETS["solve"], link)
    assert link.is_symlink()
    assert load(target).attrs["analysis"] == "solve"
    assert [path.name for path in target.parent.iterdir()] == ["result.nc"]
