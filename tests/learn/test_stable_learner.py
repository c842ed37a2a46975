"""Algorithms of Stable-Baselines3 by name: the same learning, resumed to the same bytes, tried."""

from __future__ import annotations

import json
from copy import deepcopy

import numpy as np
import pytest
from any_spaces import make_walk
from small_trainings import StopAfter, assert_same_training
from stable_baselines3 import DQN, PPO, SAC
from stable_trainings import CASES, CONTRIB, HER, OFF, ON, SPACE, config_of, trainer, tried

from surmount.core.errors import ConfigError, InputError, LearningError
from surmount.envs.batch import TaskBatch
from surmount.learn.config import LearnerConfig
from surmount.learn.recorder import Recorder
from surmount.learn.snapshot import Snapshot
from surmount.learn.trainer import Checkpointing, Trainer
from surmount.tasks.cells import TaskCells
from surmount.teachers.replay import ReplayConfig, ReplayTeacher
from surmount.workflow.monitor import Interrupted, SilentMonitor


@pytest.mark.parametrize("name", CASES)
def test_an_interruption_changes_nothing_and_the_network_can_be_tried(name, tmp_path):
    if name in CONTRIB:
        pytest.importorskip("sb3_contrib")
    algorithm, arguments, spaces, more = CASES[name]
    config = config_of(algorithm, arguments, more)
    whole = trainer(config, spaces).run(SilentMonitor())
    checkpointing = Checkpointing(path=tmp_path / "checkpoint.safetensors", interval_steps=10**9)
    with pytest.raises(Interrupted):
        trainer(config, spaces).run(StopAfter(2), checkpointing)
    assert_same_training(whole, trainer(config, spaces).run(SilentMonitor(), checkpointing))
    whole.network.save(tmp_path / "network.safetensors")
    network = Snapshot.load(tmp_path / "network.safetensors")
    first, again, other = (tried(network, spaces, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.features, again.features)
    assert first.features.shape != other.features.shape or (first.features != other.features).any()


@pytest.mark.parametrize(("made", "arguments", "actions"), [
    (PPO, ON, "discrete"), (SAC, OFF, "box"), (DQN, OFF | {"exploration_initial_eps": 0.05,
                                                           "exploration_final_eps": 0.05},
                                                "discrete"),
])  # fmt: skip
def test_it_learns_what_a_plain_script_learns(made, arguments, actions):
    ours = trainer(config_of(made.__name__, arguments), (actions, "box")).run(SilentMonitor())
    env = Recorder(TaskBatch(lambda: make_walk(actions), 4))
    plain = made("MlpPolicy", env, seed=1, **deepcopy(arguments)).learn(256)
    for name, value in plain.policy.state_dict().items():
        np.testing.assert_array_equal(value.numpy(), ours.network.tensors[f"policy/{name}"])


def test_a_next_training_begins_with_weights_optimiser_and_experience():
    config = config_of("SAC", OFF)
    first = trainer(config, ("box", "box")).run(SilentMonitor())
    assert first.memory is not None
    following = trainer(
        config, ("box", "box"), start=first.network, memory=first.memory, steps=64, seed=2
    )
    for name, value in following._learner.take().items():
        np.testing.assert_array_equal(value, first.network.tensors[name], err_msg=name)
    assert following._model.replay_buffer.pos == 64
    assert following._model.learning_starts == 0


def test_exploration_falls_once_and_stays():
    config = config_of("DQN", OFF | {"exploration_fraction": 0.5})
    first = trainer(config, ("discrete", "box"))
    assert first._model.exploration_rate == 0.0  # nothing was done yet
    first.run(SilentMonitor())
    assert first._model.exploration_rate == pytest.approx(0.05)
    start = Snapshot(tensors=first._learner.take(), record={})
    second = trainer(config, ("discrete", "box"), start=start)
    second.run(StopAfter(10**9))
    assert second._model.exploration_rate == pytest.approx(0.05)


def test_a_schedule_falls_over_the_steps_that_the_configuration_gives():
    config = config_of("PPO", ON | {"learning_rate": "linear_1e-3"}, decay_steps=512)
    learning = trainer(config, ("discrete", "box"))
    learning.run(SilentMonitor())
    rate = learning._model.policy.optimizer.param_groups[0]["lr"]
    assert rate == pytest.approx(1e-3 * (1 - 256 / 512))


def test_a_function_of_the_users_makes_the_model(tmp_path, monkeypatch):
    (tmp_path / "of_hers.py").write_text(
        "import torch\n"
        "from stable_baselines3 import PPO\n"
        "def make_model(env):\n"
        "    return PPO('MlpPolicy', env, n_steps=16, batch_size=16)\n"
        "def make_seeded(env):\n"
        "    return PPO('MlpPolicy', env, n_steps=16, batch_size=16, seed=7)\n"
        "def make_nothing(env):\n"
        "    return 3\n"
        "def make_foreign(env):\n"  # as SBX: a policy in name, its weights elsewhere
        "    model = make_model(env)\n"
        "    model.policy = type('JaxPolicy', (torch.nn.Module,), {})()\n"
        "    return model\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    trainings = [
        trainer(config_of("of_hers:make_model", {}), ("box", "box"), seed=seed, steps=64).run(
            SilentMonitor()
        )
        for seed in (1, 2)
    ]
    weights = [one.network.tensors["policy/action_net.weight"] for one in trainings]
    assert (weights[0] != weights[1]).any()
    assert tried(trainings[0].network, ("box", "box")).n_trials == 6
    for name, said in (
        ("make_seeded", "all networks would be alike"),
        ("make_nothing", "int"),
        ("make_foreign", "JaxPolicy, has no weights of PyTorch"),
    ):
        with pytest.raises(ConfigError, match=said):
            trainer(config_of(f"of_hers:{name}", {}), ("box", "box"))


@pytest.mark.parametrize(("algorithm", "arguments", "spaces", "said"), [
    ("SCA", {}, ("box", "box"), "no algorithm `SCA`"),
    ("SAC", OFF, ("discrete", "box"), "cannot learn here"),
    ("DQN", OFF, ("box", "box"), "cannot learn here"),
    ("ppo", {}, ("discrete", "box"), "learns with boxes"),
    ("ppo", {}, ("box", "image"), "pictures excepted"),
    ("PPO", {"gama": 0.9}, ("box", "box"), "no argument `gama`"),
    ("PPO", {"seed": 3}, ("box", "box"), "given by Surmount"),
    ("PPO", {"policy": "MlpPolicy"}, ("box", "image"), "as a flat vector"),
    ("PPO", {"learning_rate": "linear_1e-3"}, ("box", "box"), "nobody said over how many"),
    ("TD3", {"action_noise": {"Pink": {}}}, ("box", "box"), "action_noise"),
    ("PPO", {"policy_kwargs": {"features_extractor_class": "subprocess:Popen"}},
     ("box", "box"), "no class of PyTorch's"),
])  # fmt: skip
def test_a_misfit_is_refused_before_the_first_step(algorithm, arguments, spaces, said):
    with pytest.raises(ConfigError, match=said):
        trainer(config_of(algorithm, arguments), spaces)


def test_a_teacher_that_needs_a_critic_is_refused_before_the_first_step():
    teacher = ReplayTeacher(
        TaskCells(SPACE.parameters, SPACE.variants), total_steps=64, seed=0, config=ReplayConfig()
    )
    with pytest.raises(ConfigError, match="value errors"):
        Trainer(TaskBatch(make_walk, 4), teacher, config_of("SAC", OFF), seed=0)
    Trainer(TaskBatch(make_walk, 4), teacher, config_of("PPO", ON), seed=0)


def test_fields_of_the_own_ppo_are_refused_beside_another_algorithm():
    with pytest.raises(ConfigError, match=r"`learner.learning_rate` belongs to Surmount's own PPO"):
        LearnerConfig(algorithm="SAC", learning_rate=1e-3)
    with pytest.raises(ConfigError, match=r"`learner.epochs` belongs to Surmount's own PPO"):
        LearnerConfig(algorithm="SAC", epochs=4)
    LearnerConfig(algorithm="SAC", batch_size=512, epochs=6)  # as runs of before hold them
    with pytest.raises(ConfigError, match=r"There is no algorithm `SACC`"):
        LearnerConfig(algorithm="SACC")
    with pytest.raises(ConfigError, match="belong to an algorithm chosen by its name"):
        LearnerConfig(frame_stack=4)


def test_a_network_on_other_spaces_is_refused():
    network = trainer(config_of("PPO", ON), ("box", "box"), steps=64).run(SilentMonitor()).network
    with pytest.raises(InputError, match="does not fit"):
        tried(network, ("discrete", "box"))
    damaged = Snapshot(tensors=network.tensors, record={"algorithm": {"algorithm": 3}})
    with pytest.raises(InputError, match="record says algorithm"):
        tried(damaged, ("box", "box"))


def test_a_file_holds_json_and_arrays_alone(tmp_path):
    network = trainer(config_of("SAC", OFF | HER), ("box", "goal"), steps=256).run(SilentMonitor())
    path = tmp_path / "experience.safetensors"
    network.memory.save(path)
    size = int.from_bytes(path.read_bytes()[:8], "little")
    header = json.loads(path.read_bytes()[8 : 8 + size])
    assert {entry["dtype"] for name, entry in header.items() if name != "__metadata__"} <= {
        "F32", "F64", "I64", "BOOL", "U8"
    }  # fmt: skip


def test_a_failing_algorithm_is_a_sentence():
    learning = trainer(config_of("PPO", ON), ("box", "box"))

    def fail(*arguments, **named):
        raise ValueError("Expected parameter loc to satisfy the constraint Real()")

    learning._model.learn = fail
    with pytest.raises(LearningError, match="PPO failed after 0 steps"):
        learning.run(SilentMonitor())
