"""What the report expects of a run is what the protocol makes."""

from __future__ import annotations

import pytest

from surmount.experiment.presets import preset
from surmount.experiment.protocol import protocol
from surmount.workflow.graph import check_graph
from surmount.workflow.run_layout import EVIDENCE, expected_stages


@pytest.mark.parametrize("scale", ["smoke", "paper"])
@pytest.mark.parametrize("obstacle", ["narrow-channel", "low-entrance", "step"])
def test_the_graph_has_exactly_the_stages_that_a_report_looks_for(obstacle, scale):
    config = preset(obstacle, scale)
    graph = check_graph(protocol(config))
    assert sorted(graph) == sorted([*expected_stages(config.networks), EVIDENCE])
    assert len({stage.seed for stage in graph.values()}) == len(graph)
