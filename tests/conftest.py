"""The same numbers on every machine: one thread, and no draw that was not made before.

The profile of Hypothesis that is in force, `fixed`, draws the same cases every time, whatever ran
before them and however slowly; ``HYPOTHESIS_PROFILE=nightly`` draws new ones.
"""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

SUPPORT = Path(__file__).parent / "support"
sys.path.insert(0, str(SUPPORT))

UNTIMED = {"deadline": None, "database": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("fixed", derandomize=True, **UNTIMED)
settings.register_profile("nightly", derandomize=False, print_blob=True, **UNTIMED)
PROFILE = os.environ.get("HYPOTHESIS_PROFILE", "fixed")
settings.load_profile(PROFILE)
if PROFILE == "fixed":
    # Hypothesis also draws constants that it finds in the modules loaded so far. Which these are
    # depends on the tests that ran before in the same worker, and so on the number of cores.
    assert callable(providers._get_local_constants), "Hypothesis has renamed it: find it again."
    providers._get_local_constants = providers.Constants


@pytest.fixture(autouse=True)
def _one_thread():
    torch = sys.modules.get("torch")
    if torch is not None:
        torch.set_num_threads(1)
