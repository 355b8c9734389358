"""Tests of the surface check: surfaces with known properties, and broken ones that it must see."""

import struct
import tempfile
import unittest
from pathlib import Path

from surface import check_surface, examine

CUBE_VERTICES = [(float(x), float(y), float(z)) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
CUBE_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def torus(n: int = 8):
    """A combinatorial torus: an n by n grid of squares, wrapped both ways; only its topology matters."""
    vertices = [(float(i), float(j), 0.0) for i in range(n) for j in range(n)]
    faces = [
        (i * n + j, (i + 1) % n * n + j, (i + 1) % n * n + (j + 1) % n, i * n + (j + 1) % n)
        for i in range(n)
        for j in range(n)
    ]
    return vertices, faces


class SurfaceCheckTest(unittest.TestCase):
    def test_cube(self):
        check = examine(CUBE_VERTICES, CUBE_FACES)
        self.assertTrue(check.closed)
        self.assertEqual((check.components, check.euler, check.volume), (1, 2, 1.0))

    def test_cube_far_from_the_origin_keeps_its_volume(self):
        far = [(x + 4.5e6, y - 3e6, z + 1e6) for x, y, z in CUBE_VERTICES]
        self.assertEqual(examine(far, CUBE_FACES).volume, 1.0)

    def test_torus_has_euler_number_zero(self):
        check = examine(*torus())
        self.assertTrue(check.closed)
        self.assertEqual((check.components, check.euler), (1, 0))

    def test_two_cubes_are_two_components(self):
        vertices = CUBE_VERTICES + [(x + 3, y, z) for x, y, z in CUBE_VERTICES]
        faces = CUBE_FACES + [tuple(i + 8 for i in face) for face in CUBE_FACES]
        check = examine(vertices, faces)
        self.assertEqual((check.components, check.euler, check.volume), (2, 4, 2.0))

    def test_a_missing_face_is_seen(self):
        self.assertEqual(examine(CUBE_VERTICES, CUBE_FACES[:-1]).open_edges, 4)

    def test_a_turned_face_is_seen(self):
        self.assertFalse(examine(CUBE_VERTICES, [CUBE_FACES[0][::-1], *CUBE_FACES[1:]]).closed)

    def test_a_doubled_face_is_seen(self):
        self.assertFalse(examine(CUBE_VERTICES, [*CUBE_FACES, CUBE_FACES[0]]).closed)

    def test_inward_faces_give_a_negative_volume(self):
        self.assertEqual(examine(CUBE_VERTICES, [face[::-1] for face in CUBE_FACES]).volume, -1.0)

    def test_an_unused_vertex_is_seen(self):
        self.assertEqual(examine([*CUBE_VERTICES, (9.0, 9.0, 9.0)], CUBE_FACES).unused_vertices, 1)

    def test_reads_binary_and_ascii_alike(self):
        header = (
            "ply\nformat {}\ncomment a cube\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
            "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
        )
        binary = b"".join(struct.pack("<3d", *v) for v in CUBE_VERTICES)
        binary += b"".join(struct.pack("<B4i", 4, *f) for f in CUBE_FACES)
        lines = [" ".join(map(str, v)) for v in CUBE_VERTICES] + [f"4 {' '.join(map(str, f))}" for f in CUBE_FACES]
        with tempfile.TemporaryDirectory() as folder:
            for form, body in (("binary_little_endian 1.0", binary), ("ascii 1.0", "\n".join(lines).encode())):
                path = Path(folder) / "cube.ply"
                path.write_bytes(header.format(form).encode() + body)
                self.assertEqual(check_surface(path), examine(CUBE_VERTICES, CUBE_FACES))


if __name__ == "__main__":
    unittest.main()
