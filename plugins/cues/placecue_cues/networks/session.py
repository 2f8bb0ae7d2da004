"""A network at work: onnxruntime, with one line for each thing that can be wrong."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from placecue.errors import DataError, UnusableObservation, UsageError, choices

#: What a pixel may be handed over as.
_INPUTS = {"tensor(float)": np.float32, "tensor(float16)": np.float16, "tensor(uint8)": np.uint8}
#: No such folder can be: weights are in the file whose digest is kept, and nowhere else.
_NOWHERE = "/dev/null/none"
_TOLD = 300
#: Where in its source onnxruntime found a fault.
_SOURCE = re.compile(r"\S+\.(?:h|cc):\d+ (?:[^(]*\(.*?\) (?=[A-Z]))?")
_SILENT = 4
_NUMBERS = {f"tensor({kind})" for kind in ("float", "float16", "double", "uint8", "int8", "int32",
                                           "int64", "bool")}  # fmt: skip


class Session:
    """A network of one input, an image, ready to run.

    Parameters
    ----------
    name : str
        What messages call it.
    model : bytes
        The ONNX file.
    threads : int
        How many cores an image is computed on.

    Attributes
    ----------
    shape : list of int or str
        Of the input, (n, channels, height, width) or (n, height, width, channels); a size that is
        left open is text or None.
    outputs : dict of str to list
        The shape of each output by its name.
    takes_bytes : bool
        Whether pixels go in as they are, 0 to 255.
    """

    def __init__(self, name: str, model: bytes, threads: int = 1) -> None:
        self.name = name
        runtime = _runtime(name)
        options = runtime.SessionOptions()
        options.intra_op_num_threads = threads
        options.inter_op_num_threads = 1
        options.log_severity_level = _SILENT  # what is wrong is said in one line, by us
        options.add_session_config_entry(
            "session.model_external_initializers_file_folder_path", _NOWHERE
        )
        known = ("CUDAExecutionProvider", "CPUExecutionProvider")
        providers = [each for each in known if each in runtime.get_available_providers()]
        try:
            self._session = runtime.InferenceSession(model, options, providers=providers)
        except Exception as error:  # its errors have no common base
            if "External data" in str(error):
                raise UsageError(
                    f"{name} keeps its weights in another file: save it as one file "
                    "(onnx.save without external data)"
                ) from error
            raise DataError(
                f"{name} is no network that onnxruntime runs: {_told(error)}"
            ) from error
        self.outputs: dict[str, list[Any]] = {
            each.name: each.shape for each in self._session.get_outputs()
        }
        inputs = self._session.get_inputs()
        if len(inputs) != 1 or inputs[0].type not in _INPUTS or len(inputs[0].shape or ()) != 4:
            said = ", ".join(f"{each.name} {each.type} {each.shape}" for each in inputs)
            raise UsageError(
                f"{name} takes {said or 'nothing'}: a cue needs a network of one input of float32, "
                "float16 or uint8 and four dimensions, (n, 3, height, width) or (n, height, width, "
                "3)"
            )
        if isinstance(inputs[0].shape[0], int) and inputs[0].shape[0] != 1:
            raise UsageError(
                f"{name} takes {inputs[0].shape[0]} images at a time: export it for one, or for "
                "any number"
            )
        self._numbers = {each.name for each in self._session.get_outputs() if each.type in _NUMBERS}
        self._input, self.shape = inputs[0].name, inputs[0].shape
        self._dtype = _INPUTS[inputs[0].type]
        self.takes_bytes = self._dtype is np.uint8
        # On one core pictures one by one are faster than many at once, for want of cache.
        self._together = threads > 1 or "CUDAExecutionProvider" in self._session.get_providers()

    def output_named(self, output: str | None) -> str:
        """Return the name of an output, checked; None is the only one.

        Raises
        ------
        UsageError
            If there is none of that name, or several to choose from.
        """
        if output is None and len(self.outputs) == 1:
            output = next(iter(self.outputs))
        if output is None or output not in self.outputs:
            wanted = "no output is named" if output is None else f"it has no output '{output}'"
            raise UsageError(f"{self.name}: {wanted}; {choices(output or '', self.outputs)}")
        if output not in self._numbers:
            raise UsageError(
                f"{self.name}: output '{output}' holds no numbers; "
                f"{choices(output, sorted(self._numbers))}"
            )
        return output

    def run(self, images: NDArray[np.float32], output: str) -> NDArray[np.float64]:
        """Return an output for n images, shape (n, ...).

        Raises
        ------
        DataError
            If the network fails.
        """
        images = images.astype(self._dtype, copy=False)
        fixed = isinstance(self.shape[0], int)
        size = len(images) if self._together and not fixed else 1
        parts = [self._run(images[at : at + size], output) for at in range(0, len(images), size)]
        return np.concatenate(parts).astype(np.float64)

    def _run(self, images: NDArray[Any], output: str) -> NDArray[Any]:
        try:
            [made] = self._session.run([output], {self._input: images})
        except Exception as error:
            raise DataError(
                f"{self.name} failed on images of shape {images.shape}: {_told(error)}"
            ) from error
        made = np.asarray(made)
        if made.ndim < 2 or len(made) != len(images):
            raise DataError(
                f"{self.name}: output {output} has shape {made.shape} for {len(images)} images, "
                "not a row for each: choose another output"
            )
        if not np.isfinite(made).all():
            raise UnusableObservation(f"{self.name}: output {output} holds NaN or infinite numbers")
        return made


def _runtime(name: str) -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise UsageError(
            f"{name} needs onnxruntime ({error}): pip install 'placecue[deep]'"
        ) from error
    return onnxruntime


def _told(error: Exception) -> str:
    """Return what onnxruntime says, in one line."""
    said = " ".join(str(error).split()).removeprefix("[ONNXRuntimeError] : ")
    said = _SOURCE.sub("", said)
    return said if len(said) <= _TOLD else f"{said[:_TOLD]} ..."
