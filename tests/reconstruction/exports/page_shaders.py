"""The shaders of web pages on whatever adapter there is, by wgpu: filled in as `mirrors.js` does it."""

from __future__ import annotations

import numpy as np
import pytest

from reconstruction.exports.component_parts import THICKNESS_M, Ellipsoids, unit_quaternions
from reconstruction.exports.web import COLOUR_RANGE, glass_of, packed, packed_glass, sky_light, wgsl
from reconstruction.training.model.pane_mirrors import mirrors_of

HALF = "rgba16float"
DEGREE = 3

ASK = """
@group(1) @binding(0) var<storage, read> asked: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> replies: array<vec4f>;
@compute @workgroup_size(64)
fn reply(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= arrayLength(&asked)) { return; }
  let found = mirrored_by(u32(asked[id.x].z), asked[id.x].xy, 0u);
  replies[id.x] = vec4f(found.light, found.cosine);
}
"""


class Shaders:
    """The page's programs with one more that asks what panes mirror to pixels; the test is skipped without a device."""

    def __init__(self):
        wgpu = pytest.importorskip("wgpu", reason="wgpu is not installed: pip install wgpu")
        try:
            adapter = wgpu.gpu.request_adapter_sync()
        except RuntimeError:
            adapter = None
        if adapter is None:
            pytest.skip("no graphics adapter: apt-get install mesa-vulkan-drivers")
        self.wgpu, self.device = wgpu, adapter.request_device_sync()
        self.module = self.device.create_shader_module(code=wgsl() + ASK)

    def buffer(self, values, usage):
        return self.device.create_buffer_with_data(data=np.ascontiguousarray(values), usage=usage)

    def texture(self, levels, kind, texel_bytes, dimension):
        """Of arrays (depth, height, width, ...) or (height, width, ...), each half as large as the one before."""
        sizes = [(*level.shape[2::-1],) if dimension == "3d" else (*level.shape[1::-1], 1) for level in levels]
        usage = self.wgpu.TextureUsage.TEXTURE_BINDING | self.wgpu.TextureUsage.COPY_DST
        found = self.device.create_texture(
            size=sizes[0], format=kind, usage=usage, dimension=dimension, mip_level_count=len(levels)
        )
        for number, (level, size) in enumerate(zip(levels, sizes, strict=True)):
            layout = {"bytes_per_row": size[0] * texel_bytes, "rows_per_image": size[1]}
            place = {"texture": found, "mip_level": number}
            self.device.queue.write_texture(place, np.ascontiguousarray(level), layout, size)
        return found.create_view()

    def light_of(self, mirrors, corners_m):
        """By binding, what `mirrors.wgsl` reads of a model."""
        usage = self.wgpu.BufferUsage
        light, panes = mirrors.light_numbers(), mirrors.pane_numbers(corners_m)
        linear = dict.fromkeys(("address_mode_u", "address_mode_v", "address_mode_w"), "clamp-to-edge")
        linear |= {"mag_filter": "linear", "min_filter": "linear"}
        return {
            10: {"buffer": self.buffer(light, usage.UNIFORM)},
            11: {"buffer": self.buffer(panes, usage.STORAGE)},
            12: self.texture([mirrors.cells], HALF, 8, "3d"),
            13: self.texture([mirrors.skips], "r8uint", 1, "3d"),
            14: self.texture(mirrors.far, HALF, 8, "2d"),
            15: self.device.create_sampler(**linear),
            17: self.device.create_sampler(**{**linear, "address_mode_u": "repeat"}),
            24: {"buffer": self.buffer(np.zeros(4, np.float32), usage.STORAGE)},
        }

    def group(self, pipeline, resources, number=0):
        entries = [{"binding": binding, "resource": each} for binding, each in resources.items()]
        return self.device.create_bind_group(layout=pipeline.get_bind_group_layout(number), entries=entries)

    def compute(self, entry_point, n_groups, *resources):
        """Run a kernel on groups of resources."""
        compute = {"module": self.module, "entry_point": entry_point}
        pipeline = self.device.create_compute_pipeline(layout="auto", compute=compute)
        encoder = self.device.create_command_encoder()
        step = encoder.begin_compute_pass()
        step.set_pipeline(pipeline)
        for number, each in enumerate(resources):
            step.set_bind_group(number, self.group(pipeline, each, number))
        step.dispatch_workgroups(n_groups)
        step.end()
        self.device.queue.submit([encoder.finish()])

    def draw(self, vertex, fragment, counts, views, resources, *, blend=None, corners=None, depth=None):
        """Draw into textures; `corners` are vertices as the panes have them."""
        targets = [
            {"format": kind} | ({"blend": {"color": blend, "alpha": blend}} if blend else {}) for _, kind in views
        ]
        attributes = [
            {"format": "float32x3", "offset": 0, "shader_location": 0},
            {"format": "float32", "offset": 12, "shader_location": 1},
        ]
        buffers = [] if corners is None else [{"array_stride": 16, "attributes": attributes}]
        how = {"topology": "triangle-strip"} if blend else {"topology": "triangle-list"}
        more = {}
        if depth is not None:
            how["cull_mode"] = "back"
            more["depth_stencil"] = {
                "format": "depth32float",
                "depth_write_enabled": True,
                "depth_compare": "less-equal",
            }
        pipeline = self.device.create_render_pipeline(
            layout="auto",
            primitive=how,
            vertex={"module": self.module, "entry_point": vertex, "buffers": buffers},
            fragment={"module": self.module, "entry_point": fragment, "targets": targets},
            **more,
        )
        encoder = self.device.create_command_encoder()
        colours = [
            {"view": view.create_view(), "load_op": "clear", "store_op": "store", "clear_value": (0, 0, 0, 0)}
            for view, _ in views
        ]
        stencil = None
        if depth is not None:
            stencil = {
                "view": depth.create_view(),
                "depth_clear_value": 1.0,
                "depth_load_op": "clear",
                "depth_store_op": "discard",
            }
        step = encoder.begin_render_pass(color_attachments=colours, depth_stencil_attachment=stencil)
        step.set_pipeline(pipeline)
        step.set_bind_group(0, self.group(pipeline, resources))
        if corners is not None:
            step.set_vertex_buffer(0, corners)
        step.draw(*counts)
        step.end()
        self.device.queue.submit([encoder.finish()])

    def target(self, kind, size):
        usage = self.wgpu.TextureUsage
        flags = usage.RENDER_ATTACHMENT | usage.TEXTURE_BINDING | usage.COPY_SRC
        return self.device.create_texture(size=(*size, 1), format=kind, usage=flags)

    def mirrored(self, mirrors, corners_m, view, asked):
        """Light and cosines, shape (n, 4), of pixels counted from the middle and panes, shape (n, 3)."""
        usage, device = self.wgpu.BufferUsage, self.device
        found = device.create_buffer(size=16 * len(asked), usage=usage.STORAGE | usage.COPY_SRC)
        own = {0: {"buffer": self.buffer(view, usage.UNIFORM)}, **self.light_of(mirrors, corners_m)}
        questions = np.column_stack([asked, np.zeros(len(asked))]).astype(np.float32)
        answers = {0: {"buffer": self.buffer(questions, usage.STORAGE)}, 1: {"buffer": found}}
        self.compute("reply", -(-len(asked) // 64), own, answers)
        return np.frombuffer(device.queue.read_buffer(found), np.float32).reshape(-1, 4)

    def asked(self, mirrors, read, size, rays):
        """Answers of a network to all rays of a picture."""
        usage, n, network = self.wgpu.BufferUsage, size[0] * size[1], mirrors.network
        listed = {
            31: np.zeros((n * rays, 2, 4), np.float32),
            32: np.zeros(1, np.uint32),
            34: np.array([0, n, 0, 0], np.uint32),
            26: np.array(network.numbers, np.uint32),
            27: network.words,
            30: np.zeros((n * rays, 4), np.float32),
        }
        kinds = {34: usage.UNIFORM, 26: usage.UNIFORM}
        own = {k: {"buffer": self.buffer(each, kinds.get(k, usage.STORAGE))} for k, each in listed.items()}
        shared = {k: read[k] for k in (0, 10, 11, 20, 21)}
        self.compute("list_rays", -(-n // 64), shared | {k: own[k] for k in (31, 32, 34)} | {33: read[25]})
        groups = -(-n * rays // network.rays_a_group)
        self.compute("ask_network", groups, {k: own[k] for k in (26, 27, 30)} | {28: own[31], 29: own[32]})
        return own[30]["buffer"]

    def picture(self, model, view, size):
        """Linear light that the page shows of a model, shape (h, w, 3); of `view_numbers`, and a size in pixels."""
        usage, mirrors = self.wgpu.BufferUsage, mirrors_of(model)
        splats, n = model.splats, len(model.splats)
        ellipsoids = _ellipsoids(splats, mirrors)
        chunks = packed(ellipsoids, splats.panels.numpy(), DEGREE)
        glass = packed_glass(glass_of(mirrors, np.arange(n, dtype=np.int32), DEGREE), chunks, DEGREE)
        rows = np.where(chunks.is_on_pane, np.cumsum(chunks.is_on_pane), 0).astype(np.uint32)
        own = np.concatenate([glass.words.view(np.uint8), _spaced(glass.rest)], axis=1)
        steps = np.zeros((2, 16), np.float32)
        steps[:, :15] = chunks.rest_steps, glass.rest_steps
        depths = (chunks.words[:, :3].copy().view(np.float32) - view[0:3]) @ view[12:15]
        storage = {
            0: (view, usage.UNIFORM),
            1: (chunks.words, usage.STORAGE),
            2: (_spaced(chunks.rest), usage.STORAGE),
            3: (rows, usage.STORAGE),
            4: (own, usage.STORAGE),
            5: (np.zeros(len(model.corners_m) + 1, np.uint32), usage.STORAGE),
            6: (np.zeros((len(chunks), 4), np.uint32), usage.STORAGE),
            7: (steps, usage.UNIFORM),
            9: (np.argsort(-depths).astype(np.uint32), usage.STORAGE),
        }
        buffers = {number: {"buffer": self.buffer(values, flags)} for number, (values, flags) in storage.items()}
        self.compute("colour_splats", -(-len(chunks) // 256), {k: v for k, v in buffers.items() if k < 8})
        sums = [self.target(HALF, size) for _ in range(3)]
        mixed = {"src_factor": "one", "dst_factor": "one-minus-src-alpha"}
        needed = {0: buffers[0], 1: buffers[1], 8: buffers[6], 9: buffers[9]}
        pairs = [(each, HALF) for each in sums]
        self.draw("splat_corner", "splat_pixel", (4, len(chunks)), pairs, needed, blend=mixed)
        numbers, depth = self.target("r32uint", size), self.target("depth32float", size)
        corners = self.buffer(_pane_corners(model.corners_m), usage.VERTEX)
        pane = {0: buffers[0], 22: buffers[5]}
        n_corners = 6 * len(model.corners_m)
        pairs = [(numbers, "r32uint")]
        self.draw("pane_corner", "pane_number", (n_corners, 1), pairs, pane, corners=corners, depth=depth)
        sky = np.pad(sky_light(model.sky), ((0, 0), (0, 0), (0, 1)))
        read = dict(zip((18, 19, 20, 21), (each.create_view() for each in (*sums, numbers)), strict=True))
        read |= {0: buffers[0], 16: self.texture([sky], HALF, 8, "2d"), **self.light_of(mirrors, model.corners_m)}
        read[25] = {"buffer": self.buffer(np.zeros(size[0] * size[1], np.uint32), usage.STORAGE)}
        if mirrors.network is not None:
            read[24] = {"buffer": self.asked(mirrors, read, size, int(view[26]) ** 2)}
        shaded = self.target(HALF, size)
        self.draw("shade_corner", "shade_pixel", (3, 1), [(shaded, HALF)], read)
        width, height = size
        layout = {"bytes_per_row": 8 * width, "rows_per_image": height}
        content = self.device.queue.read_texture({"texture": shaded}, layout, (width, height, 1))
        return np.frombuffer(content, np.float16).reshape(height, width, 4)[..., :3].astype(np.float32)


def view_numbers(eye, axes, focal, size, rays, blur_px2=0.3):
    """Content of `View`, of antialiased splats."""
    low, high = COLOUR_RANGE
    right, down, forward = axes
    ends = (blur_px2, 1.0, 0.0)
    rows = [(*axis, end) for axis, end in zip((right, down, forward), ends, strict=True)]
    more = (*size, 0.0, 0.0, *size, rays, 1.0, low, high - low, DEGREE, 18.0)
    return np.array([*eye, focal, *np.ravel(rows), *more], np.float32)


def _ellipsoids(splats, mirrors):
    values = {name: value.detach().numpy() for name, value in splats.named_parameters()}
    thickness = np.full((len(splats), 1), THICKNESS_M, np.float32)
    return Ellipsoids(
        values["means"],
        unit_quaternions(values["quats"]),
        np.concatenate([np.exp(values["log_scales"]), thickness], axis=1),
        1.0 / (1.0 + np.exp(-values["opacity_logits"])),
        mirrors.sh,
        splats.panels.numpy(),
    )


def _spaced(rest):
    """Bytes of harmonics, 48 of each."""
    return np.pad(rest.reshape(len(rest), -1).view(np.uint8), ((0, 0), (0, 3)))


def _pane_corners(corners_m):
    """Two triangles each, with the pane's number + 1 below 0, as splats show it."""
    return np.array(
        [(*pane[i], -number) for number, pane in enumerate(corners_m, 1) for i in (0, 1, 2, 0, 2, 3)], np.float32
    )
