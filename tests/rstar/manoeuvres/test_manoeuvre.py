import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from surmount.core.errors import InputError
from surmount.rstar.course.batch import ObstacleVectorEnv
from surmount.rstar.course.config import EnvConfig
from surmount.rstar.course.obstacles import find_obstacle
from surmount.rstar.course.simulation import Simulation
from surmount.rstar.manoeuvres.manoeuvre import Manoeuvre, Phase, Player
from surmount.rstar.manoeuvres.search import SearchConfig, search, try_out


def phase(**changes):
    values = {
        "speed_mps": 0.1,
        "fbem_deg": 40.0,
        "sprawl_deg": 48.0,
        "until_x_m": 9.0,
        "at_most_s": 9.0,
    }
    return Phase(**{**values, **changes})


def test_targets_are_approached_at_the_limits_of_rate_and_then_held():
    player = Player([Manoeuvre(phases=(phase(fbem_deg=-7.2),))], 0.02)
    plan = np.array([player.act(np.zeros(1))[0] for _ in range(10)])
    # 0.1 m/s at 1 m/s² take 0.1 s: five steps. 7.2 deg at 80 deg/s take 0.09 s: 4.5 of them.
    assert plan[:, 0] == pytest.approx([1, 1, 1, 1, 1, 0, 0, 0, 0, 0], abs=1e-9)
    assert plan[:, 1] == pytest.approx([-1, -1, -1, -1, -0.5, 0, 0, 0, 0, 0], abs=1e-9)
    assert plan[:, 2] == pytest.approx(np.zeros(10), abs=1e-9)


def test_phases_end_by_position_or_by_time_whichever_is_first():
    phases = (phase(until_x_m=-0.1, at_most_s=0.1), phase(until_x_m=0.1, at_most_s=9.0), phase())
    player = Player([Manoeuvre(phases=phases)] * 2, 0.02)
    seen = []
    for x in [(-0.3, -0.3)] * 2 + [(-0.3, -0.05)] * 4 + [(-0.3, 0.2)] * 2:
        player.act(np.array(x))
        seen.append(player.phase.tolist())
    # The first robot never moves: its first phase ends after five steps of 0.02 s. The other
    # passes −0.1 m at the third step and 0.1 m at the seventh.
    assert [first for first, _ in seen] == [0, 0, 0, 0, 0, 1, 1, 1]
    assert [second for _, second in seen] == [0, 0, 1, 1, 1, 1, 2, 2]


def test_a_manoeuvre_plays_the_same_in_the_search_and_in_the_environment():
    manoeuvre = Manoeuvre(
        phases=(
            phase(speed_mps=0.2, fbem_deg=-30.0, sprawl_deg=20.0, until_x_m=0.0),
            phase(speed_mps=0.25, fbem_deg=50.0, sprawl_deg=25.0),
        )
    )
    config = EnvConfig()
    simulation = Simulation(find_obstacle("narrow-channel"), config, 1, 1)
    trials = try_out(simulation, config, np.array([250.0]), [manoeuvre], 10.0)
    env = ObstacleVectorEnv(
        "narrow-channel", 1, config=config, autoreset_mode=AutoresetMode.DISABLED
    )
    obs, _ = env.reset(seed=0, options={"variant": 250.0, "start": "fixed"})
    player = Player([manoeuvre], config.step_s)
    for step in range(500):  # noqa: B007
        obs, _, terminated, _, infos = env.step(player.act(-0.3 * obs[:, 4]))
        if terminated[0]:
            break
    assert trials.success[0]
    assert infos["is_success"][0]
    assert trials.time_s[0] == pytest.approx((step + 1) * config.step_s, abs=1e-9)


def test_the_search_opens_a_channel_that_the_start_pose_does_not_fit():
    # The start pose is 248 mm wide; driving straight on does not pass 200 mm.
    config = EnvConfig()
    straight = Manoeuvre(phases=(phase(fbem_deg=0.0),))
    small = SearchConfig(population=24, elite=6, iterations=4, phases=2, horizon_s=8.0)
    obstacle = find_obstacle("narrow-channel")
    simulation = Simulation(obstacle, config, 24, 1)
    assert not try_out(simulation, config, np.array([200.0]), [straight], 8.0).success[0]
    result = search(obstacle, config, 200.0, small, seed=0, simulation=simulation)
    assert result.manoeuvre is not None
    again = try_out(simulation, config, np.array([200.0]), [result.manoeuvre], 8.0)
    assert again.success[0]


def test_manoeuvres_survive_their_records_and_bad_ones_are_refused():
    manoeuvre = Manoeuvre(phases=(phase(), phase(fbem_deg=-72.0)))
    assert Manoeuvre.from_record(manoeuvre.to_record()) == manoeuvre
    record = manoeuvre.to_record()
    for wrong in (
        [],
        [{**record[0], "speed_mps": 0.3}],
        [{**record[0], "fbem_deg": float("nan")}],
        [{**record[0], "extra": 1.0}],
        [{"speed_mps": 0.1}],
        ["phase"],
        [{**record[0], "sprawl_deg": "wide"}],
    ):
        with pytest.raises(InputError):
            Manoeuvre.from_record(wrong)
