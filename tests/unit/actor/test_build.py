"""What an actor is built of."""

import shutil

import pytest

from services.actor.build import newest_on_disk
from services.actor.config import ActorSettings
from shared.errors import PolicyError
from shared.policies.checkpoint import bundled


@pytest.mark.parametrize(("name", "most"), [("looks", 4), ("history", 4)])
def test_more_memory_than_the_high_level_has_is_refused_also_after_a_restart(tmp_path, name, most):
    settings = ActorSettings.model_validate({"data": tmp_path, "rollout": {name: most + 1}})
    with pytest.raises(PolicyError, match=f"set {name} to {most} or less"):
        newest_on_disk(settings)
    shutil.copytree(bundled("high_level"), tmp_path / "high_level")
    with pytest.raises(PolicyError, match=f"set {name} to {most} or less"):
        newest_on_disk(settings)
    fitting = settings.model_copy(update={"rollout": ActorSettings().rollout})
    assert newest_on_disk(fitting).net.looks == 4
