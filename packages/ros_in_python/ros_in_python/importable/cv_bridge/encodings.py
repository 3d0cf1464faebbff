"""The encodings of images, and their conversion. Names: sensor_msgs/image_encodings.hpp."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

#: OpenCV's depths, in the order of its numbers, and numpy's types.
DEPTHS = {
    "8U": "uint8",
    "8S": "int8",
    "16U": "uint16",
    "16S": "int16",
    "32S": "int32",
    "32F": "float32",
    "64F": "float64",
}
_CHANNELS = {"rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4, "mono": 1}
_TWO_CHANNELS = ("yuv422", "yuv422_yuy2", "uyvy", "yuyv")
_ONE_CHANNEL = ("nv21", "nv24")
_COLOUR = re.compile(r"(rgba?|bgra?|mono)(8|16)")
_BAYER = re.compile(r"bayer_(?:rggb|bggr|gbrg|grbg)(8|16)")
_PLAIN = re.compile(r"(8U|8S|16U|16S|32S|32F|64F)C?(\d*)")
#: OpenCV names a pattern by its second row, and ROS by its first.
_PATTERNS = {"rggb": "BG", "bggr": "RG", "gbrg": "GR", "grbg": "GB"}
_YUV = {**dict.fromkeys(("yuv422", "uyvy"), "YUV2BGR_UYVY"), **dict.fromkeys(("yuv422_yuy2", "yuyv"), "YUV2BGR_YUY2")}
#: Weights of red, green and blue in grey: ITU-R BT.601.
_GREY = (0.299, 0.587, 0.114)


def type_of(encoding: str) -> tuple[str, int]:
    """Return numpy's type and the number of channels of an encoding. Raises ValueError for one that is not known."""
    if match := _COLOUR.fullmatch(encoding):
        return f"uint{match[2]}", _CHANNELS[match[1]]
    if match := _BAYER.fullmatch(encoding):
        return f"uint{match[1]}", 1
    if match := _PLAIN.fullmatch(encoding):
        return DEPTHS[match[1]], int(match[2] or 1)
    if encoding in (*_TWO_CHANNELS, *_ONE_CHANNEL):
        return "uint8", 2 if encoding in _TWO_CHANNELS else 1
    raise ValueError(f"Unrecognized image encoding [{encoding}]")


def cv_type(dtype: str, channels: int) -> int:
    """Return OpenCV's number of a type, which differs between its versions: 16 for `8UC3`, without it as in 4."""
    place = list(DEPTHS.values()).index(dtype)
    try:
        import cv2
    except ImportError:
        return place + ((channels - 1) << 3)
    return int(getattr(cv2, f"CV_{list(DEPTHS)[place]}C{channels}"))


def converted(image: Any, source: str, target: str) -> Any:
    """Return an image in another encoding. Raises ValueError if it makes no sense, or OpenCV is missing."""
    if source == target:
        return image
    colours = [_COLOUR.fullmatch(name) for name in (source, target)]
    if all(colours):
        return _depth(_colour(image, colours[0][1], colours[1][1]), *type_of(target))  # type: ignore[index]
    plain = [_PLAIN.fullmatch(name) is not None for name in (source, target)]
    if all(plain):
        if type_of(source)[1] != type_of(target)[1]:
            raise ValueError(f"[{source}] and [{target}] do not have the same number of channels")
        return image.astype(type_of(target)[0])
    if any(plain):
        if type_of(source) == type_of(target):
            return image
        raise ValueError(f"[{source}] and [{target}]: one is a color format and the other is not")
    return _by_opencv(image, source, target)


def _colour(image: Any, source: str, target: str) -> Any:
    if source == target:
        return image
    if source == "mono":
        channels = dict.fromkeys("rgb", image)
    else:
        channels = {name: image[..., place] for place, name in enumerate(source)}
    if target == "mono":
        grey = sum(weight * channels[name].astype(float) for weight, name in zip(_GREY, "rgb", strict=True))
        return np.rint(grey).astype(image.dtype)
    opaque = np.full(image.shape[:2], np.iinfo(image.dtype).max, image.dtype)
    return np.stack([channels.get(name, opaque) for name in target], axis=-1)


def _depth(image: Any, dtype: str, channels: int) -> Any:
    if image.dtype == dtype:
        return image
    # 255 and 65535 are both white.
    return image.astype(dtype) * 257 if dtype == "uint16" else np.rint(image / 257).astype(dtype)


def _by_opencv(image: Any, source: str, target: str) -> Any:
    try:
        import cv2
    except ImportError:
        raise ValueError(f"from [{source}] to [{target}] needs OpenCV: pip install opencv-python-headless") from None
    match = _BAYER.fullmatch(source)
    start = f"Bayer{_PATTERNS[source[6:10]]}2BGR" if match else _YUV.get(source)
    code = getattr(cv2, f"COLOR_{start}", None)
    if code is None:
        raise ValueError(f"from [{source}] to [{target}] is not supported")
    return converted(cv2.cvtColor(image, code), f"bgr{match[1] if match else 8}", target)
