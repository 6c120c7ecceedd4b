"""Readers, runs, scores and files."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import mosbench
from mosbench import _mosbench


def cpu_s(process_id):
    """Returns the CPU time that a process has used."""
    fields = open(f"/proc/{process_id}/stat").read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_open_gives_scans_and_speaks_as_kiss_icp_does(street):
    sequence = mosbench.open(street)
    assert sequence.name == "08" and len(sequence) == 12
    assert mosbench.open(street, sequence="08").name == "08"
    assert mosbench.open(street, sequences=["08"])["08"].name == "08"
    scan = sequence.scan(-1)
    assert scan.stamp == pytest.approx(1.1) and scan.stamp_ns == 1_100_000_000
    assert scan.index == 11 and scan.stem == "000011" and scan.points.dtype == np.float32
    assert scan.truth.shape == (len(scan.points),) and scan.pose.shape == (4, 4)
    points, times = sequence[11]
    assert points.shape == (len(scan.points), 3) and points.dtype == np.float64 and times.size == 0
    assert np.array_equal(sequence.gt_poses[11], scan.pose)
    with pytest.raises(IndexError):
        sequence.scan(12)
    with pytest.raises(OSError, match="nowhere"):
        mosbench.open("nowhere")
    with pytest.raises(ValueError, match="07"):
        mosbench.open(street, sequence="07")


def test_scans_of_an_aeva_have_radial_velocities(tmp_path, street):
    data = mosbench.open(mosbench.simulate(tmp_path / "sim", layout="helipr", scene="room", scans=2))
    scan = data["room/Aeva"].scan(1)
    assert scan.radial_velocity_m_s.dtype == np.float32 and scan.radial_velocity_m_s.shape == (len(scan.points),)
    assert scan.truth is None and data["room/Ouster"].scan(1).radial_velocity_m_s is None
    assert mosbench.open(street).scan(0).radial_velocity_m_s is None


def test_run_keeps_what_the_result_says(street, finished):
    assert finished.method == "HMM-MOS" and finished.simulated
    per_scan = finished.per_scan
    assert len(per_scan) == 12 and per_scan["labelled"].all() and not per_scan["judged"][0]
    counts = [int(per_scan[name].sum()) for name in ("tp", "fp", "fn")]
    assert finished.iou == pytest.approx(counts[0] / sum(counts))
    assert finished.header["method"]["kind"] == "hmm-mos"
    assert "08" in repr(finished) and "<td>08</td>" in finished._repr_html_()
    moving = (finished["08"].labels("000011") == mosbench.MOVING_LABEL).sum()
    assert moving == per_scan["moving"][11]


def test_score_of_the_labels_is_the_score_of_the_run(street, finished, tmp_path):
    scored = mosbench.score(street, finished.folder, protocol="semantickitti-mos", out=tmp_path / "kept")
    assert scored.metrics == finished.metrics and (tmp_path / "kept").is_dir()
    assert mosbench.stats(finished)["sequences"][0]["name"] == "08"
    with pytest.raises(ValueError, match="protocol"):
        mosbench.score(street, finished.folder, protocol="nothing")
    with pytest.raises(OSError):
        mosbench.Result(street)


@pytest.mark.parametrize("protocol", ["semantickitti-mos", "doals-hmm", "helimos-all", "mapmos"])
def test_pooled_counts_give_the_numbers_of_score(street, finished, protocol):
    counts = [
        mosbench.confusion(finished["08"].labels(scan.stem), scan.truth, protocol, scan.points)
        for scan in mosbench.open(street)
    ]
    scored = mosbench.score(street, finished, protocol)
    assert mosbench.pooled(counts, protocol) == scored.metrics
    assert mosbench.pooled([counts], protocol) == scored.metrics
    ious = finished.per_scan["iou"]
    if protocol == "semantickitti-mos":
        assert mosbench.mean_of_scans(counts) == pytest.approx(np.nanmean(ious))
        assert mosbench.mean_of_scans(counts) != mosbench.pooled(counts, protocol)["iou"]
    with pytest.raises(ValueError, match="scans: is empty"):
        mosbench.pooled([])


def test_a_simulated_sequence_says_so_wherever_it_lies(street, tmp_path):
    assert mosbench.open(street).simulated
    moved = shutil.copytree(next(street.rglob("velodyne")).parent, tmp_path / "mine")
    assert mosbench.open(moved).simulated and "simulated" in repr(mosbench.open(moved))
    (moved / "simulated.json").unlink()
    assert not mosbench.open(moved).simulated


def test_iou_counts_as_the_protocol_does(street, finished):
    scan = mosbench.open(street).scan(11)
    labels = finished["08"].labels(scan.stem)
    row = finished.per_scan[11]
    counts = mosbench.confusion(labels, scan.truth)
    assert [counts[name] for name in ("tp", "fp", "fn", "tn")] == [row[n] for n in ("tp", "fp", "fn", "tn")]
    truth = np.array([False, True, True, False])
    found = np.array([False, True, False, False])
    for protocol in mosbench.protocols():
        points = np.full((4, 3), 3.0)
        assert mosbench.metrics(found, truth, protocol, points)["recall"] == pytest.approx(0.5), protocol
    assert mosbench.iou(found, truth) == 0.5
    assert mosbench.iou(truth & False, truth & False) is None
    with pytest.raises(ValueError, match="4 points, expected 3"):
        mosbench.iou(found, truth[:3])
    with pytest.raises(ValueError, match="limits the range"):
        mosbench.iou(found, truth, "doals-hmm")


def test_iou_refuses_the_classes_of_a_network(street):
    scan = mosbench.open(street).scan(11)
    assert (scan.truth > 0xFFFF).any()
    assert mosbench.iou(scan.truth_ids > 250, scan.truth) == 1.0
    truth = np.array([9, 9, 251, 251], np.uint32)
    assert mosbench.iou(truth > 250, truth) == 1.0
    for classes in ((truth > 250).astype(int), np.where(truth > 250, 2, 1).astype(np.uint8)):
        with pytest.raises(ValueError, match="predicted: holds no other ids than 0, 1 and 2"):
            mosbench.iou(classes, truth)


def test_run_takes_data_sets_of_others(street, near, finished, tmp_path):
    class Theirs:
        def __init__(self):
            self.gt_poses = mosbench.open(street).gt_poses

        def __len__(self):
            return 12

        def __getitem__(self, index):
            return mosbench.open(street)[index]

    result = mosbench.run(Theirs(), config=near, out=tmp_path / "theirs")
    assert result.iou is None and result.sequences[0].name == "Theirs"
    finished_ns = (result.sequences[0].folder / "result.json").stat().st_mtime_ns
    result = mosbench.run(Theirs(), config=near, out=tmp_path / "theirs")
    assert (result.sequences[0].folder / "result.json").stat().st_mtime_ns == finished_ns
    for scan in mosbench.open(street):
        assert np.array_equal(result.sequences[0].labels(scan.stem), finished["08"].labels(scan.stem))


def test_run_and_score_take_what_open_returned(street, near, finished, tmp_path):
    for data in (mosbench.open(street), mosbench.open(street, sequences=["08"])):
        result = mosbench.run(data, config=near, out=tmp_path / "run")
        assert result.metrics == finished.metrics
        assert mosbench.score(data, result.folder, "semantickitti-mos").metrics == finished.metrics
        assert mosbench.doctor(data).content["sequences"][0]["name"] == "08"


def test_open_reads_poses_as_told_or_none(street, near, tmp_path):
    own = mosbench.open(street).gt_poses
    assert (mosbench.open(street, poses=False).gt_poses == np.eye(4)).all()
    file = tmp_path / "poses.txt"
    np.savetxt(file, np.linalg.inv(own)[:, :3].reshape(-1, 12))
    inverse = mosbench.open(street, poses=file, pose_frame="lidar", pose_direction="sensor-from-map")
    assert np.allclose(inverse.gt_poses, own)
    # Where the poses of the data set are those of the lidar, the labels are the same.
    result = mosbench.run(inverse, config=near, out=tmp_path / "run")
    assert result.header["reading"]["pose_direction"] == "sensor_from_map, inverted"
    with pytest.raises(TypeError, match="unexpected keyword argument 'posed_frame'"):
        mosbench.open(street, posed_frame="lidar")
    with pytest.raises(ValueError, match="^pose_frame: "):
        mosbench.open(street, pose_frame="wheel")


def test_runs_are_compared_and_broken_down(street, near, finished, tmp_path):
    other = mosbench.run(street, config=near.replace(min_otsu_score=3), out=tmp_path / "other")
    assert len(mosbench.diff(finished, other, top=2)["scans"]) == 2
    same, drop = mosbench.compare(finished, finished), finished.iou - other.iou
    assert same.ok and drop > 0.001
    with pytest.raises(OSError, match="min_otsu_score.*; even_if compares them"):
        mosbench.compare(finished, other)
    assert not mosbench.compare(finished, other, even_if=True, max_drop=100 * drop / 2).ok
    assert mosbench.breakdown(street, finished)
    assert mosbench.table("I")["table"] == "I"


def test_methods_are_ranked_and_scores_give_a_curve(street, near, finished, tmp_path):
    scored = mosbench.run(street, method="underwood", scores=True, out=tmp_path / "underwood")
    board = mosbench.rank(finished, scored)
    assert {row["method"] for row in board["rows"]} == {finished.method, scored.method}
    curve = mosbench.curve(scored, picture=tmp_path / "curve.png")
    assert 0 <= curve["average_precision"] <= 1
    assert (tmp_path / "curve.png").read_bytes().startswith(b"\x89PNG")


def test_run_writes_what_is_asked_for(street, near, tmp_path):
    for write in ("boxes", ["static-cloud", "static-cloud-pcd", "boxes"]):
        folder = mosbench.run(street, config=near, out=tmp_path / "run", write=write)["08"].folder
        assert len(json.loads((folder / "boxes.json").read_text())["scans"]) == 12
        assert (folder / "static.ply").exists() == ("static-cloud" in write)
        assert (folder / "static.pcd").exists() == ("static-cloud-pcd" in write)
    with pytest.raises(ValueError, match="cubes"):
        mosbench.run(street, config=near, out=tmp_path / "run", write=["cubes"])


def test_run_takes_what_counts_as_moving(street, tmp_path):
    run = mosbench.run(street, preset="best", moving="ever:3", out=tmp_path / "run")["08"]
    assert json.loads((run.folder / "result.json").read_text())["settings"]["object_age_s"] == 3
    with pytest.raises(ValueError, match="hmm-mos-plus"):
        mosbench.run(street, method="hmm-mos", moving="ever", out=tmp_path / "refused")


def test_run_takes_one_method(street, tmp_path):
    for several in ("all", "yoon,underwood"):
        with pytest.raises(ValueError, match="names several"):
            mosbench.run(street, method=several, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_reading_has_every_flag_of_the_program():
    assert set(mosbench.READING) == set(_mosbench.reading_names())


def test_scans_are_chosen_as_from_a_list(street):
    stems = [scan.stem for scan in mosbench.open(street)]
    for part in (slice(3, None), slice(None, 5), slice(1, 9, 3), slice(None, None, 2), slice(4, 100)):
        assert [scan.stem for scan in mosbench.open(street, scans=part)] == stems[part]
    assert [scan.stem for scan in mosbench.open(street, scans="2:9:4")] == stems[2:9:4]
    for bad in (slice(-3, None), slice(5, 5), "5:x"):
        with pytest.raises(ValueError, match="^scans: .* is no range of scans"):
            mosbench.open(street, scans=bad)
    with pytest.raises(ValueError, match="^scans 99: chooses no scan of sequence 08, which has 12 scans"):
        mosbench.open(street, scans=slice(99, None))


def test_disturbances_are_those_of_the_program(street, tmp_path):
    plain, tilted = mosbench.open(street).scan(3), mosbench.open(street, perturb="mount_tilt_deg=5").scan(3)
    assert plain.points.shape == tilted.points.shape
    assert (plain.points[:, 2] != tilted.points[:, 2]).any()
    simulated = mosbench.simulate(tmp_path / "sparse", scans=2, perturb="dropout_probability=1")
    assert not mosbench.open(simulated).scan(1).points.any()
    with pytest.raises(ValueError, match='^perturb: "mount_tilt" is not known.*nearest: mount_tilt_deg'):
        mosbench.open(street, perturb="mount_tilt=5")


def test_errors_speak_of_arguments(street, tmp_path):
    with pytest.raises(ValueError, match="^preset: .*sipailuo") as raised:
        mosbench.run(street, preset="sipailuo", out=tmp_path / "run")
    assert "--" not in str(raised.value) and "nearest: sipailou" in str(raised.value)
    with pytest.raises(ValueError, match="nearest: hmm-mos"):
        mosbench.MOS(method="hmm-moss")
    with pytest.raises(ValueError, match="setting: 'voxel_size' is not known.*nearest: voxel_size_m"):
        mosbench.Config(voxel_size=0.25)
    with pytest.raises(FileNotFoundError):
        mosbench.Config.load(tmp_path / "nothing.json")


def test_odometry_is_of_one_sequence(tmp_path):
    data = mosbench.open(mosbench.simulate(tmp_path / "sensors", layout="helimos", scans=3))
    assert len(data) == 4
    with pytest.raises(ValueError, match="are 4 sequences, expected one"):
        mosbench.odometry(data)
    assert mosbench.odometry(data["Ouster"]).shape == (3, 4, 4)


class Turning:
    """Scans of a room around a sensor that drives along x at 5 m/s, as KISS-ICP's data sets give them."""

    def __init__(self, times):
        self.times = times
        self.gt_poses = np.stack([self.pose(k) for k in range(6)])

    @staticmethod
    def pose(scan):
        pose = np.eye(4)
        pose[0, 3] = 0.5 * scan
        return pose

    def __len__(self):
        return 6

    def __getitem__(self, k):
        if k >= len(self):
            raise IndexError
        when = np.repeat(np.arange(360) / 360, 8)
        azimuth = 2 * np.pi * when
        height = np.tile(np.linspace(-1, 2, 8), 360)
        # Walls at x = 12, -8, y = 9, -7, as they are seen from where the sensor is by then.
        x = 0.5 * (k + when)
        along = [(np.where(np.cos(azimuth) > 0, 12, -8) - x) / np.cos(azimuth),
                 np.where(np.sin(azimuth) >= 0, 9, -7) / np.where(np.sin(azimuth) == 0, 1e-9, np.sin(azimuth))]  # fmt: skip
        reach = np.minimum(*along)
        points = np.stack([reach * np.cos(azimuth), reach * np.sin(azimuth), height], axis=1)
        return points, self.times(when)


def test_odometry_takes_a_folder_and_kiss_icps_data_sets_with_their_times(street):
    assert np.array_equal(mosbench.odometry(street), mosbench.odometry(mosbench.open(street, poses=False)))
    for times in (lambda when: when, lambda when: 1e3 + 0.1 * when):
        moved = mosbench.odometry(Turning(times), min_range_m=1.0)
        assert np.abs(moved - Turning(times).gt_poses)[:, :3, 3].max() < 0.1
    still = mosbench.odometry(Turning(lambda when: when), min_range_m=1.0, deskew="none")
    without = mosbench.odometry(Turning(lambda when: np.zeros(0)), min_range_m=1.0)
    assert np.array_equal(still, without) and not np.array_equal(still, moved)
    with pytest.raises(ValueError, match="scan 0: has 1 times for 2880 points"):
        mosbench.odometry(Turning(lambda when: np.zeros(1)))


def test_run_moves_the_points_of_kiss_icps_data_sets_by_their_times(near, tmp_path):
    data = Turning(lambda when: when)
    result = mosbench.run(data, config=near, out=tmp_path / "run", deskew="poses")
    assert result.header["reading"]["point_times"].startswith("s since the scan's stamp, span")
    bins = sorted((tmp_path / "run-data/Turning/velodyne").iterdir())
    assert np.allclose(np.fromfile(bins[3], "<f4").reshape(-1, 5)[:, 4], 0.1 * data[3][1])
    plain = mosbench.run(data, config=near, out=tmp_path / "plain")
    assert "deskew" not in plain.header["reading"]
    with pytest.raises(ValueError, match="scan 0: has no times of points"):
        mosbench.run(Turning(lambda when: np.zeros(0)), config=near, out=tmp_path / "none", deskew="poses")


def test_other_threads_run_meanwhile(street, near, tmp_path):
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(len(ticks))

    thread = threading.Thread(target=tick)
    thread.start()
    before = len(ticks)
    mosbench.run(street, config=near, out=tmp_path / "run", threads=1)
    during = len(ticks) - before
    done.set()
    thread.join()
    assert during > 12  # more than the chances that one scan after the other would give


def test_two_threads_may_run_at_once(street, near, finished, tmp_path):
    results = {}

    def work(name):
        results[name] = mosbench.run(street, config=near, out=tmp_path / name)

    threads = [threading.Thread(target=work, args=(name,)) for name in ("a", "b")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [results[name].metrics for name in ("a", "b")] == [finished.metrics] * 2


def test_progress_is_printed_only_when_wanted(street, near, tmp_path, capfd):
    mosbench.run(street, config=near, out=tmp_path / "run")
    assert capfd.readouterr() == ("", "")
    mosbench.run(street, config=near, out=tmp_path / "run", overwrite=True, progress=True)
    assert "scan 12/12" in capfd.readouterr().err


def test_doctor_is_content_with_sound_data(street):
    checkup = mosbench.doctor(street)
    assert checkup.content["sequences"][0]["scans"] == 12
    assert checkup.ok == (not checkup.symptoms)


def test_an_interrupt_ends_the_doctor(street):
    start_s = time.process_time()
    mosbench.doctor(street)
    whole_s = time.process_time() - start_s
    before = signal.signal(signal.SIGPROF, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_PROF, whole_s / 10)
        start_s = time.process_time()
        with pytest.raises(KeyboardInterrupt):
            mosbench.doctor(street)
        assert time.process_time() - start_s < 0.8 * whole_s
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def test_report_is_one_file(finished, tmp_path):
    file = finished.report(tmp_path / "report.html", max_mb=5)
    assert file.read_text().startswith("<!")


def test_to_pandas_has_a_row_per_scan(finished):
    pandas = pytest.importorskip("pandas")
    table = finished.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == 12


def test_ctrl_c_ends_a_run_and_leaves_what_a_later_one_continues(tmp_path):
    data, out = mosbench.simulate(tmp_path / "data", layout="helimos", scans=12), tmp_path / "out"
    code = (
        "import mosbench, sys, time\n"
        "try:\n"
        f"    mosbench.run({str(data)!r}, out={str(out)!r})\n"
        "except KeyboardInterrupt:\n"
        "    print(time.process_time(), flush=True)\n"
        "    sys.exit(42)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    while not (list(out.glob("*/result.json")) and list(out.glob("*.partial/labels/*"))):
        assert process.poll() is None
        time.sleep(0.005)
    before_s = cpu_s(process.pid)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 42
    # In CPU time, as the machine may be busy; one thread or more, each a second.
    assert float(process.stdout.readline()) - before_s < 1.0
    finished = {file: file.stat().st_mtime_ns for file in out.glob("*/result.json")}
    assert 0 < len(finished) < 4 and not list(out.glob("*.partial"))
    assert len(mosbench.run(data, out=out).sequences) == 4
    assert all(file.stat().st_mtime_ns == then for file, then in finished.items())


def test_fills_dufo_of_h5(street, near, tmp_path):
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "scene.h5"
    scans = list(mosbench.open(street))
    with h5py.File(file, "w") as out:
        for scan in scans:
            group = out.create_group(str(10**9 + scan.index * 10**8))
            group["lidar"], group["pose"] = scan.points, scan.pose
    assert mosbench.moving_for_h5(file, near) == 12
    mos = mosbench.MOS(near, scan_count=12)
    with h5py.File(file) as labelled:
        for scan, stamp in zip(scans, sorted(labelled, key=int)):
            expected = mos.push(scan.points[:, :3], scan.pose)[0].moving
            assert labelled[stamp]["dufo"].dtype == np.uint8
            assert np.array_equal(labelled[stamp]["dufo"][:].astype(bool), expected)
    before = file.read_bytes()
    with pytest.raises(ValueError, match="dufo already"):
        mosbench.moving_for_h5(file, near)
    with h5py.File(tmp_path / "other.h5", "w") as out:
        out.create_group("1")["lidar"] = scans[0].points
    with pytest.raises(ValueError, match="no pose"):
        mosbench.moving_for_h5(tmp_path / "other.h5")
    assert file.read_bytes() == before and not list(tmp_path.glob("*.partial"))


def test_a_cleaned_map_is_scored(tmp_path):
    def ply(name, *rows):
        file = tmp_path / name
        header = f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n"
        header += "".join(f"property float {word}\n" for word in ("x", "y", "z", "intensity"))
        file.write_text(header + "end_header\n" + "".join(row + "\n" for row in rows))
        return file

    truth = ply("truth.ply", "0 0 0 0", "1 0 0 0", "2 0 0 1")
    answer = mosbench.map_score(ply("map.ply", "0 0 0 0"), truth)
    assert (answer["sa"], answer["da"]) == (0.5, 1.0)
    assert mosbench.map_score(truth, truth, same_within_m=0.1)["da"] == 0.0
    with pytest.raises(OSError, match="intensity 7"):
        mosbench.map_score(truth, ply("no_truth.ply", "0 0 0 7"))
