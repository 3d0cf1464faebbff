"""Point clouds become arrays and back."""

from __future__ import annotations

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header

XYZ = [(1.0, 2.0, 3.0), (4.0, float("nan"), 6.0), (7.0, 8.0, 9.0)]
MIXED = [
    PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1),
    PointField(name="ring", offset=8, datatype=PointField.UINT16, count=1),
]


def test_what_is_made_of_three_coordinates_is_read_again() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="lidar"), XYZ)
    assert (cloud.width, cloud.height, cloud.point_step, cloud.row_step) == (3, 1, 12, 36)
    assert point_cloud2.read_points_list(cloud, skip_nans=True) == [XYZ[0], XYZ[2]]
    assert point_cloud2.read_points(cloud, field_names=("z", "x"))[2].item() == (9.0, 7.0)
    assert point_cloud2.read_points_numpy(cloud, uvs=[2, 0]).tolist() == [list(XYZ[2]), list(XYZ[0])]


def test_fields_have_their_offsets_and_types() -> None:
    cloud = point_cloud2.create_cloud(Header(), MIXED, [(0.5, 7), (1.5, 8)], point_step=12)
    assert (cloud.point_step, len(cloud.data)) == (12, 24)
    points = point_cloud2.read_points(cloud)
    assert points["ring"].tolist() == [7, 8]
    with pytest.raises(ValueError, match=r"different types: x .*ring"):
        point_cloud2.read_points_numpy(cloud)
    with pytest.raises(ValueError, match=r"no field 'y'. Its fields: x, ring"):
        point_cloud2.read_points(cloud, field_names=["y"])


def test_an_organized_cloud_keeps_rows_and_columns_and_is_read_by_column_and_row() -> None:
    points = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    cloud = point_cloud2.create_cloud_xyz32(Header(), points)
    assert (cloud.height, cloud.width) == (2, 3)
    assert point_cloud2.read_points_numpy(cloud, reshape_organized_cloud=True).tolist() == points.tolist()
    assert point_cloud2.read_points_numpy(cloud, uvs=[(2, 1)]).tolist() == [[15.0, 16.0, 17.0]]


def test_the_other_order_of_bytes_and_padded_rows_are_read() -> None:
    cloud = PointCloud2(height=2, width=1, point_step=4, row_step=6, is_bigendian=True, is_dense=True)
    cloud.fields = [PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1)]
    cloud.data = np.array([1.5], ">f4").tobytes() + b"\0\0" + np.array([2.5], ">f4").tobytes() + b"\0\0"
    assert point_cloud2.read_points(cloud)["x"].tolist() == [1.5, 2.5]
