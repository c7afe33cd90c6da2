"""The forward pass of a small BERT in plain torch: word pieces in, one vector a sentence out.

B sentences, T word pieces, D = 384 channels, A = 12 heads. Inference only.

Source: Devlin et al. 2019 (arXiv 1810.04805), post-norm encoder; sentence vectors by the mean
over word pieces, as Reimers and Gurevych 2019 (arXiv 1908.10084).
"""

import torch
from torch import Tensor
from torch.nn import functional as F

Tensors = dict[str, Tensor]
HEADS = 12
EPSILON = 1e-12


def embed(tensors: Tensors, tokens: Tensor, mask: Tensor) -> Tensor:
    """Unit vectors [B, D] float32 of padded word pieces [B, T] int64; mask [B, T] bool."""
    return pool(states(tensors, tokens, mask)[-1], mask)


def states(tensors: Tensors, tokens: Tensor, mask: Tensor) -> list[Tensor]:
    """What every layer makes of each word piece, [B, T, D] each; the first is of no layer yet."""
    found = [_read(tensors, tokens)]
    while f"encoder.layer.{len(found) - 1}.output.dense.weight" in tensors:
        found.append(_layer(tensors, f"encoder.layer.{len(found) - 1}.", found[-1], mask))
    return found


def pool(last: Tensor, mask: Tensor) -> Tensor:
    """Unit vectors [B, D] of the last layer's states [B, T, D]."""
    kept = mask.unsqueeze(-1).to(last.dtype)
    mean = (last * kept).sum(1) / kept.sum(1)
    return F.normalize(mean, dim=-1)


def _read(tensors: Tensors, tokens: Tensor) -> Tensor:
    words = F.embedding(tokens, tensors["embeddings.word_embeddings.weight"])
    places = tensors["embeddings.position_embeddings.weight"][: tokens.shape[1]]
    kinds = tensors["embeddings.token_type_embeddings.weight"][0]
    return _norm(tensors, "embeddings.LayerNorm", words + places + kinds)


def _layer(tensors: Tensors, prefix: str, x: Tensor, mask: Tensor) -> Tensor:
    attended = _linear(
        tensors, prefix + "attention.output.dense", _attend(tensors, prefix, x, mask)
    )
    x = _norm(tensors, prefix + "attention.output.LayerNorm", x + attended)
    hidden = F.gelu(_linear(tensors, prefix + "intermediate.dense", x))
    out = _linear(tensors, prefix + "output.dense", hidden)
    return _norm(tensors, prefix + "output.LayerNorm", x + out)


def _attend(tensors: Tensors, prefix: str, x: Tensor, mask: Tensor) -> Tensor:
    queries, keys, values = (
        _linear(tensors, f"{prefix}attention.self.{name}", x).reshape(*x.shape[:2], HEADS, -1)
        for name in ("query", "key", "value")
    )
    mixed = F.scaled_dot_product_attention(
        queries.transpose(1, 2),
        keys.transpose(1, 2),
        values.transpose(1, 2),
        attn_mask=mask[:, None, None, :],
    )
    return mixed.transpose(1, 2).flatten(-2)


def _linear(tensors: Tensors, name: str, x: Tensor) -> Tensor:
    return F.linear(x, tensors[name + ".weight"], tensors[name + ".bias"])


def _norm(tensors: Tensors, name: str, x: Tensor) -> Tensor:
    weight, bias = tensors[name + ".weight"], tensors[name + ".bias"]
    return F.layer_norm(x, (x.shape[-1],), weight, bias, EPSILON)


def as_batch(pieces: list[list[int]]) -> tuple[Tensor, Tensor]:
    """Padded word pieces [B, T] int64 and their mask [B, T] bool."""
    width = max(len(row) for row in pieces)
    tokens = torch.zeros(len(pieces), width, dtype=torch.int64)
    mask = torch.zeros(len(pieces), width, dtype=torch.bool)
    for row, ids in enumerate(pieces):
        tokens[row, : len(ids)] = torch.tensor(ids)
        mask[row, : len(ids)] = True
    return tokens, mask
