"""Images of messages as numpy arrays, and back."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import CompressedImage, Image

from cv_bridge.encodings import DEPTHS, converted, cv_type, type_of


class CvBridgeError(TypeError):
    """An image can't be converted."""


class CvBridge:
    """Converts images. OpenCV is needed for compressed images, Bayer patterns and YUV alone."""

    def __init__(self) -> None:
        self.numpy_type_to_cvtype = {dtype: depth for depth, dtype in DEPTHS.items()} | DEPTHS
        self.cvdepth_to_numpy_depth = dict(enumerate(DEPTHS.values()))
        self.cvtype_to_name = {
            cv_type(dtype, count): f"{depth}C{count}" for depth, dtype in DEPTHS.items() for count in range(1, 5)
        }

    def dtype_with_channels_to_cvtype2(self, dtype: Any, n_channels: int) -> str:
        """Return OpenCV's name of a type, such as `8UC3`."""
        return f"{self.numpy_type_to_cvtype[np.dtype(dtype).name]}C{n_channels}"

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's number of an encoding's type. Raises CvBridgeError."""
        return cv_type(*self.encoding_to_dtype_with_channels(encoding))

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return numpy's type and the number of channels of an encoding. Raises CvBridgeError."""
        try:
            return type_of(encoding)
        except ValueError as error:
            raise CvBridgeError(str(error)) from None

    def imgmsg_to_cv2(self, img_msg: Image, desired_encoding: str = "passthrough") -> Any:
        """Return an image as an array: height × width, or height × width × channels if it has more than one.

        Raises CvBridgeError for an encoding that is not known, a conversion that makes no sense, and too little data.
        """
        name, channels = self.encoding_to_dtype_with_channels(img_msg.encoding)
        dtype = np.dtype(name).newbyteorder(">" if img_msg.is_bigendian else "<")
        rows: NDArray[np.uint8] = np.frombuffer(bytes(img_msg.data), np.uint8)
        if img_msg.step < img_msg.width * channels * dtype.itemsize or rows.size < img_msg.height * img_msg.step:
            raise CvBridgeError(
                f"{rows.size} bytes in rows of {img_msg.step} are too few for {img_msg.width}×{img_msg.height} pixels"
            )
        rows = rows[: img_msg.height * img_msg.step].reshape(img_msg.height, img_msg.step)
        pixels = np.ascontiguousarray(rows[:, : img_msg.width * channels * dtype.itemsize]).view(dtype)
        shape = (img_msg.height, img_msg.width) if channels == 1 else (img_msg.height, img_msg.width, channels)
        return self._converted(pixels.reshape(shape).astype(name), img_msg.encoding, desired_encoding)

    def compressed_imgmsg_to_cv2(self, cmprs_img_msg: CompressedImage, desired_encoding: str = "passthrough") -> Any:
        """Return a compressed image as an array, whose colours OpenCV has in the order blue, green, red."""
        image = _opencv().imdecode(np.frombuffer(bytes(cmprs_img_msg.data), np.uint8), -1)
        if image is None:
            raise CvBridgeError(f"the data is no image of the format {cmprs_img_msg.format!r}")
        return self._converted(image, "bgr8" if image.ndim == 3 else "mono8", desired_encoding)

    def cv2_to_imgmsg(self, cvim: Any, encoding: str = "passthrough", header: Any = None) -> Image:
        """Return an array as a message. Raises TypeError for no array, and CvBridgeError for another type of pixels."""
        _check_array(cvim)
        kind = self.dtype_with_channels_to_cvtype2(cvim.dtype, 1 if cvim.ndim < 3 else cvim.shape[2])
        if encoding != "passthrough" and self.cvtype_to_name[self.encoding_to_cvtype2(encoding)] != kind:
            raise CvBridgeError(f"encoding specified as {encoding}, but image has incompatible type {kind}")
        message = Image(
            height=cvim.shape[0], width=cvim.shape[1], encoding=kind if encoding == "passthrough" else encoding
        )
        if header is not None:
            message.header = header
        order = cvim.dtype.byteorder
        message.is_bigendian = order == ">" or (order == "=" and sys.byteorder == "big")
        message.data.frombytes(np.ascontiguousarray(cvim).tobytes())
        message.step = len(message.data) // max(1, message.height)
        return message

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> CompressedImage:
        """Return an array as a compressed image, such as `jpg` or `png`."""
        _check_array(cvim)
        succeeded, data = _opencv().imencode(f".{dst_format}", cvim)
        if not succeeded:
            raise CvBridgeError(f"OpenCV can't write the format {dst_format!r}")
        message = CompressedImage(format=dst_format)
        message.data.frombytes(data.tobytes())
        return message

    def _converted(self, image: Any, source: str, target: str) -> Any:
        try:
            return image if target == "passthrough" else converted(image, source, target)
        except ValueError as error:
            raise CvBridgeError(str(error)) from None


def _check_array(image: Any) -> None:
    if not isinstance(image, np.ndarray | np.generic):
        raise TypeError("Your input type is not a numpy array")


def _opencv() -> Any:
    try:
        import cv2
    except ImportError:
        raise CvBridgeError("compressed images need OpenCV: pip install opencv-python-headless") from None
    return cv2
