"""How observations become arrays, and how training varies them."""

import numpy as np
import torch

from shared.goals.language.encoder import shared_encoder
from shared.policies.reading import forgetful, past_vectors, relit, shifted


def test_a_history_is_right_aligned_and_padded_with_zeros() -> None:
    encoder = shared_encoder()
    vectors = past_vectors(encoder, [(), ("wait",), ("a", "b", "wait", "wait", "put it down")], 4)
    wait, put = encoder.embed(["wait", "put it down"])
    assert not vectors[0].any()
    assert not vectors[1, :3].any()
    assert np.array_equal(vectors[1, 3], wait)
    assert np.array_equal(vectors[2, 1:], [wait, wait, put])


def test_a_shift_moves_whole_pictures_by_a_few_pixels() -> None:
    images = torch.zeros(1, 2, 64, 64, 3, dtype=torch.uint8)
    images[:, :, 30, 30] = 255
    moved = shifted(images, 3, np.random.default_rng(0))
    for view in moved[0]:
        rows, columns = torch.nonzero(view[..., 0], as_tuple=True)
        assert len(rows) == 1
        assert abs(int(rows[0]) - 30) <= 3
        assert abs(int(columns[0]) - 30) <= 3
    assert torch.equal(shifted(images, 0, np.random.default_rng(0)), images)


def test_other_light_is_the_same_for_both_views_of_a_sample() -> None:
    pixels = torch.full((3, 2, 64, 64, 3), 100.0)
    lit = relit(pixels, 0.2, 0.1, 0.0, np.random.default_rng(0))
    assert torch.equal(lit[:, 0], lit[:, 1])
    assert len(np.unique(lit[:, 0, 0, 0].numpy(), axis=0)) == 3
    noisy = relit(pixels, 0.0, 0.0, 5.0, np.random.default_rng(0))
    assert 4.0 < float(noisy.std()) < 6.0


def test_some_histories_are_forgotten_whole() -> None:
    past = torch.ones(200, 4, 384)
    kept = forgetful(past, 0.25, np.random.default_rng(0)).flatten(1)
    assert {0.0, 1.0} == set(np.unique(kept.numpy()))
    assert 0.6 < float(kept.mean()) < 0.9
    assert torch.equal(kept.amin(1), kept.amax(1))
