"""Networks of torch read layer by layer, so that they need no torch afterwards."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError, short_repr

if TYPE_CHECKING:
    from torch import Tensor, nn

#: Torch's activations by class: the name in a policy, and the attributes that a module must have.
_ACTIVATIONS: Mapping[str, tuple[str, Mapping[str, object]]] = {
    "Tanh": ("tanh", {}),
    "ReLU": ("relu", {}),
    "ELU": ("elu", {"alpha": 1.0}),
    "GELU": ("gelu", {"approximate": "none"}),
}
_SKIPPED = ("Identity", "Dropout", "NormalParamExtractor")
_ACCEPTED = (
    "linear layers with biases, each followed by a LayerNorm or none, and then by one of "
    f"{', '.join(_ACTIVATIONS)} or none"
)
#: Number of observations on which a module is tried, and the largest accepted difference from the
#: output of its layers.
_TRIAL_ROWS, _OUTPUT_TOLERANCE = 16, 1e-4


@dataclass
class ModuleLayer:
    """A linear layer, its normalization if it has one, and its activation."""

    #: Shape (inputs, outputs), the transpose of torch's.
    weight: NDArray[np.float32]
    bias: NDArray[np.float32]
    norm: tuple[NDArray[np.float32], NDArray[np.float32], float] | None = None
    activation: str = "identity"


def read_module(module: "nn.Module", *, has_spread: bool = False) -> list[ModuleLayer]:
    """Return the layers of a ``torch.nn.Module``; refuse one that is not a sequence of them.

    With `has_spread`, or if a ``NormalParamExtractor`` ends it, the second of two outputs is
    dropped: the spread of a distribution.
    """
    leaf_modules = _leaf_modules(module)
    layers: list[ModuleLayer] = []
    for leaf in leaf_modules:
        if type(leaf).__name__ not in _SKIPPED:
            _append_module(layers, leaf)
    if not layers:
        raise ParameterError(f"a module with no linear layer is not accepted: {_ACCEPTED}")
    _check_activations_between(layers)
    _check_output(module, layers)
    last = layers[-1]
    if has_spread or type(leaf_modules[-1]).__name__ == "NormalParamExtractor":
        if len(last.bias) != 2 or last.norm is not None or last.activation != "identity":
            raise ParameterError(
                f"a last layer with {len(last.bias)} outputs is not accepted with a spread: two, a "
                "mean and a spread, and nothing after them"
            )
        last.weight, last.bias = last.weight[:, :1], last.bias[:1]
    elif len(last.bias) == 2:
        raise ParameterError(
            "a last layer with 2 outputs is not accepted: one, the rudder of a leader; if they are "
            "the mean and the spread of a distribution, say so with has_spread=True"
        )
    return layers


def _leaf_modules(module: "nn.Module") -> list[Any]:
    """Return the modules that hold no others, in their order.

    One without weights may stand at several places, such as a single activation for all layers. One
    with weights counts at its first place: at others it may have a second name.
    """
    leaf_modules: list[Any] = []
    for _, child in module.named_modules(remove_duplicate=False):
        is_seen = any(child is leaf for leaf in leaf_modules)
        is_repeat = is_seen and next(child.parameters(), None) is not None
        if next(child.children(), None) is None and not is_repeat:
            leaf_modules.append(child)
    return leaf_modules


def _as_array(tensor: "Tensor") -> NDArray[np.float32]:
    array: NDArray[np.float32] = tensor.detach().cpu().float().numpy()
    return array


def _append_module(layers: list[ModuleLayer], module: Any) -> None:
    """Append a linear module as a layer; add a LayerNorm or an activation to the last layer."""
    kind, last = type(module).__name__, layers[-1] if layers else None
    has_no_activation = last is not None and last.activation == "identity"
    if kind == "Linear" and module.bias is not None:
        layers.append(ModuleLayer(_as_array(module.weight).T, _as_array(module.bias)))
    elif kind == "LayerNorm" and last is not None and has_no_activation and last.norm is None:
        size = len(last.bias)
        scale, shift = np.ones(size, np.float32), np.zeros(size, np.float32)
        if module.weight is not None:
            scale = _as_array(module.weight)
        if module.bias is not None:
            shift = _as_array(module.bias)
        last.norm = (scale, shift, float(module.eps))
    elif kind in _ACTIVATIONS and last is not None and has_no_activation:
        name, settings = _ACTIVATIONS[kind]
        for setting, accepted in settings.items():
            if (value := getattr(module, setting)) != accepted:
                raise ParameterError(
                    f"{setting} = {value!r} of {kind} is not accepted: {accepted!r}"
                )
        last.activation = name
    else:
        raise ParameterError(
            f"a module with the layer {short_repr(module)} at this position is not accepted: "
            f"{_ACCEPTED}"
        )


def _check_activations_between(layers: list[ModuleLayer]) -> None:
    """Refuse two linear layers with neither a normalization nor an activation between them."""
    for first, second in itertools.pairwise(layers):
        if first.activation == "identity" and first.norm is None:
            raise ParameterError(
                f"a module is not accepted in which a linear layer with {len(second.bias)} outputs "
                f"follows one with {len(first.bias)} and nothing stands between them: activations "
                "that forward calls as functions are not seen, so write them as layers in "
                "torch.nn.Sequential"
            )


def _check_output(module: "nn.Module", layers: list[ModuleLayer]) -> None:
    """Refuse a module whose output for random rows is not that of its layers in their order."""
    import torch

    output, expected = _outputs_on_trial(module, layers)
    tensors = [tensor.float().cpu() for tensor in _tensors(output)]
    if any(tensor.shape[:-1] != (_TRIAL_ROWS,) for tensor in tensors):
        tensors = []  # Other shapes than (rows, outputs) cannot be joined; they are refused below.
    # The empty tensor is for outputs without tensors, which torch.cat refuses.
    joined = torch.cat([torch.empty(_TRIAL_ROWS, 0), *tensors], dim=-1)
    # The mean alone is compared: a distribution's spread is made positive after the last layer.
    columns = 1 if len(tensors) == 2 else expected.shape[1]
    # NaN is equal here: a policy refuses weights that are not finite, with a better message.
    is_same = joined.shape == expected.shape and torch.allclose(
        joined[:, :columns], expected[:, :columns], atol=_OUTPUT_TOLERANCE, equal_nan=True
    )
    if not is_same:
        raise ParameterError(
            f"a module is not accepted that computes something else than its {len(layers)} linear "
            f"layers one after another, {_ACCEPTED}: write it as torch.nn.Sequential, or take an "
            "object with predict"
        )


def _outputs_on_trial(module: "nn.Module", layers: list[ModuleLayer]) -> tuple[object, "Tensor"]:
    """Return a module's output for random rows, and that of its layers in their order."""
    import torch

    size = len(layers[0].weight)
    rows = np.random.default_rng(0).uniform(-1.0, 1.0, (_TRIAL_ROWS, size)).astype(np.float32)
    modes = [(part, part.training) for part in module.modules()]
    module.eval()
    try:
        with torch.no_grad():
            output = module(torch.from_numpy(rows).to(next(module.parameters())))
            expected = torch.from_numpy(rows)
            for layer in layers:
                expected = _layer_output(layer, expected)
    except RuntimeError as error:  # The layers' shapes do not fit each other.
        raise ParameterError(
            f"a module is not accepted whose layers do not fit each other in their order: {error}"
        ) from error
    except Exception as error:  # The module's own forward may raise anything.
        raise ParameterError(
            "a module is not accepted that cannot be run on observations: "
            f"{type(error).__name__}: {error}"
        ) from error
    finally:
        for part, was_training in modes:
            part.training = was_training
    return output, expected


def _tensors(output: object) -> Iterator[Any]:
    """Yield the tensors of an output, such as the mean and the spread of a distribution."""
    if isinstance(output, tuple | list):
        for part in output:
            yield from _tensors(part)
    elif hasattr(output, "detach"):
        yield output


def _layer_output(layer: ModuleLayer, values: "Tensor") -> "Tensor":
    """Return a layer's output, computed by torch."""
    import torch

    functions = torch.nn.functional
    values = functions.linear(values, *map(torch.tensor, (layer.weight.T.copy(), layer.bias)))
    if layer.norm is not None:
        scale, shift, epsilon = layer.norm
        weight, bias = map(torch.tensor, (scale, shift))
        values = functions.layer_norm(values, (len(scale),), weight, bias, epsilon)
    if layer.activation == "identity":
        return values
    is_tanh = layer.activation == "tanh"
    activation = torch.tanh if is_tanh else getattr(functions, layer.activation)
    activated: Tensor = activation(values)
    return activated
