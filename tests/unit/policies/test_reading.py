"""How observations become arrays, and how training varies them."""

import numpy as np
import torch

from shared.goals.language.encoder import shared_encoder
from shared.policies.reading import (
    blinking,
    forgetful,
    gains,
    halved,
    past_vectors,
    read_words,
    relit,
    shifted,
)


def test_a_history_is_right_aligned_and_padded_with_zeros() -> None:
    encoder = shared_encoder()
    vectors = past_vectors(encoder, [(), ("wait",), ("a", "b", "wait", "wait", "put it down")], 4)
    wait, put = encoder.embed(["wait", "put it down"])
    assert not vectors[0].any()
    assert not vectors[1, :3].any()
    assert np.array_equal(vectors[1, 3], wait)
    assert np.array_equal(vectors[2, 1:], [wait, wait, put])


def test_prompts_are_read_piece_by_piece_whatever_they_are_read_with() -> None:
    alone = read_words(shared_encoder(), ["no tomato"])
    both = read_words(shared_encoder(), ["a sandwich without any tomato", "no tomato"])
    length = int(alone.there.sum())
    assert both.there.sum(1).tolist()[1] == length < both.there.shape[1]
    assert torch.equal(both.states[1, :length], alone.states[0])
    assert not both.states[1, length:].any()


def test_a_shift_moves_whole_pictures_and_repeats_their_edges() -> None:
    images = np.zeros((2, 8, 8, 3), np.uint8)
    images[:, 4, 4], images[:, 0] = 255, 9
    moved = shifted(images, np.array([[2, -1], [0, 0]]), 3)
    assert np.argwhere(moved[0, ..., 0] == 255).tolist() == [[6, 3]]
    assert (moved[0, :3] == 9).all()
    assert np.array_equal(moved[1], images[1])


def test_half_a_picture_has_the_mean_of_each_four_pixels() -> None:
    images = np.arange(2 * 4 * 4 * 3).reshape(2, 4, 4, 3).astype(np.uint8)
    means = images.reshape(2, 2, 2, 2, 2, 3).mean((2, 4))
    assert np.array_equal(halved(images), means.astype(np.uint8))


def test_other_light_is_the_same_for_all_pictures_of_a_sample() -> None:
    rng = np.random.default_rng(0)
    pictures = np.full((3, 2, 64, 64, 3), 100, np.uint8)
    lit = relit(pictures, gains(3, 0.2, 0.1, rng), 0.0, rng)
    assert torch.equal(lit[:, 0], lit[:, 1])
    assert len(np.unique(lit[:, 0, 0, 0].numpy(), axis=0)) == 3
    noisy = relit(pictures, torch.ones(3, 3), 5.0, rng)
    assert 4.0 < float(noisy.std()) < 6.0


def test_some_histories_are_forgotten_whole_and_single_commands_of_others() -> None:
    past = torch.ones(400, 4, 384)
    kept = forgetful(past, 0.25, 0.1, np.random.default_rng(0)).mean(2)
    assert {0.0, 1.0} == set(np.unique(kept.numpy()))
    assert 0.15 < float((kept.sum(1) == 0).float().mean()) < 0.35
    assert ((kept.sum(1) > 0) & (kept.sum(1) < 4)).any()


def test_the_present_look_is_never_hidden() -> None:
    seen = np.array([[False, True, True, True]] * 200)
    shown = blinking(seen, 0.3, 0.2, np.random.default_rng(0))
    assert shown[:, -1].all()
    assert not shown[:, 0].any()
    assert 0.3 < shown[:, 1].mean() < 0.8
