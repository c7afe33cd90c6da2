"""What paired trials say of a candidate."""

from services.learner.trials import TrialSettings, compare

SETTINGS = TrialSettings(episodes=20)


def won(count: int, of: int = 20) -> list[bool]:
    return [number < count for number in range(of)]


def test_a_candidate_that_falls_far_behind_is_refused_and_a_little_is_chance() -> None:
    reason, figures = compare(won(6), won(16), SETTINGS)
    assert "succeeds in 6 of 20 scenes, the version in force in 16 of the same" in reason
    assert figures["difference"] == -0.5
    assert compare(won(15), won(16), SETTINGS)[0] == ""
    assert compare(won(18), won(16), SETTINGS)[0] == ""


def test_a_candidate_that_never_succeeds_is_refused_where_the_weakest_version_did() -> None:
    reason, _ = compare(won(0), won(1), SETTINGS)
    assert reason.startswith("it succeeds in none of 20 scenes, the version in force in 1 of")
    assert compare(won(0), won(0), SETTINGS)[0] == ""  # Nothing is known of either.
