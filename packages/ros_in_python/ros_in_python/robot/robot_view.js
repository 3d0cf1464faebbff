// Draws a robot from the data of drawing.py: `showRobot(place, data)`, with WebGL 2 and without a library.
// Rotations are quaternions, and a pose is [x, y, z, qx, qy, qz, qw]. still.py paints the same picture without a browser.
"use strict";

globalThis.showRobot = (() => {
  const RED = [0.85, 0.16, 0.12];
  const VIEW = { azimuth: 0.5, elevation: 0.16 };
  // The height of the picture is 2 / FOCAL of the distance.
  const FOCAL = 3.6;
  // As many balls of shapes throw shadows; fewer without a graphics card.
  const [BALLS, FEW_BALLS] = [96, 20];
  // Where it comes from: towards the viewer, to the left, up; it turns with the viewer.
  const LIGHT = [0.35, 0.5, 0.8];
  // Without a graphics card, this time is left to the page's nodes between two pictures.
  const SLOW_GAP_MS = 120;
  // A recording that has ended goes back to its start in this time.
  const BACK_S = 0.8;

  const VERTEX = `#version 300 es
    in vec3 corner; out vec3 normal, at;
    uniform vec3 place, half_, eye; uniform vec4 turn; uniform mat3 view; uniform vec2 zoom; uniform int kind; uniform float edge;
    vec3 turned(vec3 v) { return v + 2. * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }
    void main() {
      // A ball of the radius of the edges, its parts moved apart: every shape has soft edges.
      vec3 inner = half_ - edge;
      vec3 core = kind == 0 ? sign(corner) * inner : vec3(normalize(corner.xy) * inner.x, sign(corner.z) * inner.z);
      normal = turned(corner);
      at = place + turned(kind == 2 ? corner * half_ : kind == 3 ? corner * 8. * half_.x * vec3(1, 1, 0) : core + corner * edge);
      vec3 seen = (at - eye) * view;
      gl_Position = vec4(seen.xy * zoom, -seen.z * 1.02 - .02 * zoom.y, -seen.z);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float; precision highp int;
    in vec3 normal, at; out vec4 result;
    uniform vec3 colour, light, eye; uniform vec4 balls[${BALLS}]; uniform int count, kind; uniform vec4 ground;
    float shadow() {
      float lit = 1.;
      for (int i = 0; i < count; i++) {
        float height = max(balls[i].z - ground.z, 0.), wide = balls[i].w * .75 + height * .22;
        vec2 away = at.xy - balls[i].xy + light.xy / light.z * height;
        lit *= 1. - .6 * balls[i].w * balls[i].w / (wide * wide) * exp(-dot(away, away) / (2. * wide * wide));
      }
      return 1. - lit;
    }
    float open(vec3 n) {
      float free = 1.;
      for (int i = 0; i < count; i++) {
        vec3 to = balls[i].xyz - at; float far = length(to), size = balls[i].w / far;
        if (size < .9) free *= 1. - .75 * max(dot(n, to) / far, 0.) * size * size;
      }
      return free * (.75 + .25 * smoothstep(-.2, 1., (at.z - ground.z) / ground.w + n.z));
    }
    void main() {
      if (kind == 3) {
        float edge = 1. - smoothstep(.2, .72, length(at.xy - ground.xy) / ground.w);
        if (edge <= 0.) discard;
        float dark = shadow() * edge * .62;
        result = vec4(vec3(.5, .56, .56) * .16 * edge * (1. - dark), .16 * edge + dark * (1. - .16 * edge));
        return;
      }
      vec3 n = normalize(normal), to = normalize(eye - at);
      float lit = max(dot(n, light) * .72 + .28, 0.), rim = pow(1. - max(dot(n, to), 0.), 3.);
      float shine = pow(max(dot(n, normalize(light + to)), 0.), 40.) * .22;
      vec3 sky = mix(vec3(.42, .44, .47), vec3(.62, .66, .7), n.z * .5 + .5);
      result = vec4(colour * (sky + lit * vec3(.58, .55, .5)) * open(n) + shine + rim * .1, 1);
    }`;

  // A ball whose corners avoid the planes through its middle, where VERTEX takes it apart.
  function ball(steps) {
    const corners = [];
    const triangles = [];
    for (const [a, b, c, sign] of [[0, 1, 2, 1], [1, 2, 0, 1], [2, 0, 1, 1], [1, 0, 2, -1], [2, 1, 0, -1], [0, 2, 1, -1]]) {
      const first = corners.length / 3;
      for (let i = 0; i <= steps; i++) {
        for (let j = 0; j <= steps; j++) {
          const v = [];
          [v[a], v[b], v[c]] = [Math.tan((i / steps - 0.5) * Math.PI / 2), Math.tan((j / steps - 0.5) * Math.PI / 2), sign];
          corners.push(...v.map((x) => x / Math.hypot(...v)));
          const k = first + i * (steps + 1) + j;
          if (i < steps && j < steps) triangles.push(k, k + steps + 1, k + 1, k + 1, k + steps + 1, k + steps + 2);
        }
      }
    }
    return { corners: new Float32Array(corners), triangles: new Uint16Array(triangles) };
  }

  const turned = ([x, y, z, w], [a, b, c]) => {
    const [p, q, r] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p];
  };
  const moved = (pose, point) => turned(pose.slice(3), point).map((value, axis) => value + pose[axis]);
  // Where a pose in the frame `outer` is.
  function placed(outer, pose) {
    const [[ax, ay, az, aw], [bx, by, bz, bw]] = [outer.slice(3), pose.slice(3)];
    const turn = [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
    return [...moved(outer, pose.slice(0, 3)), ...turn];
  }

  // Where each link is, by its number. A joint's parent comes before it.
  function links({ joints }, positions) {
    const poses = [[0, 0, 0, 0, 0, 0, 1]];
    for (const joint of joints) {
      const position = positionOf(joint, positions) ?? joint.rest;
      const length = Math.hypot(...joint.axis) || 1;
      const [axis, sine] = [joint.axis.map((x) => x / length), Math.sin(position / 2)];
      const own =
        joint.kind === "prismatic" ? [...axis.map((x) => x * position), 0, 0, 0, 1] : [0, 0, 0, ...axis.map((x) => x * sine), Math.cos(position / 2)];
      const moves = ["prismatic", "revolute", "continuous"].includes(joint.kind);
      poses[joint.child] = placed(poses[joint.parent], moves ? placed(joint.origin, own) : joint.origin);
    }
    return poses;
  }

  function positionOf({ name, mimic }, positions) {
    if (!mimic) return positions[name];
    const [leader, multiplier, offset] = mimic;
    return leader in positions ? multiplier * positions[leader] + offset : undefined;
  }

  const isOutside = ({ limits }, position) => limits && position !== undefined && !(limits[0] <= position && position <= limits[1]);
  const number = (value) => value.toFixed(2).replace("-", "−");

  // The joints in words, as in_words of drawing.py has them.
  function words(data, positions, only = () => true) {
    return data.joints.flatMap((joint) => {
      const position = positionOf(joint, positions);
      if (position === undefined || !only(joint, position)) return [];
      const beyond = isOutside(joint, position) ? ` (beyond its limits, ${joint.limits.map(number).join(" to ")})` : "";
      return `${joint.name.replaceAll("_", " ")} ${number(position)} ${joint.kind === "prismatic" ? "m" : "rad"}${beyond}`;
    });
  }

  // The middle of a robot at rest, its radius, and the height of the ground.
  function extent({ shapes }, poses) {
    const corners = shapes.flatMap(([link, , half, origin]) => {
      const pose = placed(poses[link], origin);
      return [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => moved(pose, half.map((x, axis) => (bits & (1 << axis) ? x : -x))));
    });
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => pick(...corners.map((c) => c[axis]))));
    return { middle: low.map((x, axis) => (x + high[axis]) / 2), radius: Math.hypot(...low.map((x, axis) => high[axis] - x)) / 2 || 1, ground: low[2] };
  }

  // The balls that stand for a shape when it throws a shadow: [x, y, z, radius].
  function ballsOf([, , half], pose) {
    const [, radius, longest] = [...half].sort((a, b) => a - b);
    const axis = half.indexOf(longest);
    const count = Math.min(3, Math.max(1, Math.round(longest / radius)));
    return Array.from({ length: count }, (_, i) => {
      const point = [0, 0, 0];
      point[axis] = count > 1 ? (longest - radius) * ((2 * i) / (count - 1) - 1) : 0;
      return [...moved(pose, point), radius];
    });
  }

  // Return a function that paints the robot as seen from a side, or null if this browser has no WebGL 2.
  function painter(canvas, data) {
    const gl = canvas.getContext("webgl2");
    if (!gl) return null;
    const card = gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
    const fast = !/swiftshader|llvmpipe|software|basic render/i.test(card);
    const sharpness = fast ? Math.min(devicePixelRatio, 2) : 1;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    const mesh = ball(fast ? 9 : 5);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, mesh.corners, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles, gl.STATIC_DRAW);
    const corner = gl.getAttribLocation(program, "corner");
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 3, gl.FLOAT, false, 0, 0);
    gl.enable(gl.DEPTH_TEST);
    const known = {};
    const uniform = (name) => (known[name] ??= gl.getUniformLocation(program, name));
    const { middle, radius, ground } = extent(data, links(data, {}));

    const draw = (kind, pose, half, edge, colour) => {
      gl.uniform1i(uniform("kind"), kind);
      gl.uniform3fv(uniform("place"), pose.slice(0, 3));
      gl.uniform4fv(uniform("turn"), pose.slice(3));
      gl.uniform3fv(uniform("half_"), half);
      gl.uniform1f(uniform("edge"), edge);
      gl.uniform3fv(uniform("colour"), colour);
      gl.drawElements(gl.TRIANGLES, mesh.triangles.length, gl.UNSIGNED_SHORT, 0);
    };

    const paint = ({ azimuth, elevation }, positions) => {
      const [width, height] = ["clientWidth", "clientHeight"].map((side) => Math.round(canvas[side] * sharpness));
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      gl.viewport(0, 0, width, height);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
      const [right, up, back] = [[-sa, ca, 0], [-ca * se, -sa * se, ce], [ca * ce, sa * ce, se]];
      const far = radius * 1.0 * FOCAL;
      const light = [ca * LIGHT[0] + sa * LIGHT[1], sa * LIGHT[0] - ca * LIGHT[1], LIGHT[2]];
      gl.uniform3fv(uniform("eye"), back.map((x, axis) => middle[axis] + x * far));
      gl.uniformMatrix3fv(uniform("view"), false, [...right, ...up, ...back]);
      gl.uniform2f(uniform("zoom"), (FOCAL * height) / width, FOCAL);
      gl.uniform3fv(uniform("light"), light.map((x) => x / Math.hypot(...light)));
      gl.uniform4f(uniform("ground"), middle[0], middle[1], ground, radius);
      const poses = links(data, positions);
      const shapes = data.shapes.map((shape) => [shape, placed(poses[shape[0]], shape[3])]);
      const balls = shapes.flatMap(([shape, pose]) => ballsOf(shape, pose)).sort((a, b) => b[3] - a[3]);
      balls.splice(fast ? BALLS : FEW_BALLS);
      gl.uniform4fv(uniform("balls"), balls.flat());
      gl.uniform1i(uniform("count"), balls.length);
      const red = new Set(data.joints.filter((joint) => isOutside(joint, positionOf(joint, positions))).map((joint) => joint.child));
      for (const [[link, kind, half, origin, colour], pose] of shapes) {
        // The joint itself is red; the rest of its link only turns reddish.
        const part = !red.has(link) ? 0 : Math.hypot(...origin.slice(0, 3)) < 1e-6 ? 1 : 0.55;
        const edge = Math.min(...half) * (kind === "box" ? 0.62 : 0.45);
        draw({ box: 0, cylinder: 1, sphere: 2 }[kind], pose, half, edge, colour.map((x, i) => x + part * (RED[i] - x)));
      }
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      draw(3, [middle[0], middle[1], ground, 0, 0, 0, 1], [radius / 4, 1, 1], 0, RED);
      gl.disable(gl.BLEND);
    };
    return { paint, gap: fast ? 0 : SLOW_GAP_MS };
  }
  // Where a recording's joints are after so many seconds. At its end, they go back to the start.
  function positionsAt({ times, positions }, seconds) {
    const end = times.at(-1) ?? 0;
    const now = seconds % (end + BACK_S);
    const next = times.findIndex((time) => time > now);
    const [from, to, part] =
      next < 0 ? [times.length - 1, 0, (now - end) / BACK_S] : [next - 1, next, (now - times[next - 1]) / (times[next] - times[next - 1])];
    return Object.fromEntries(Object.entries(positions).map(([name, values]) => [name, values[from] + part * (values[to] - values[from])]));
  }

  // Replace the still picture in `place` by one that moves and can be turned. Without WebGL 2, the still picture stays.
  // The result's `move(positions)` shows joints that move now; `say(text)` shows a text instead of the joints' state.
  return (place, data) => {
    const make = (tag, properties) => Object.assign(document.createElement(tag), properties);
    const canvas = make("canvas", { tabIndex: 0, className: "robot-canvas" });
    canvas.setAttribute("role", "img");
    // A page's policy forbids styles in its text, but not those of scripts.
    Object.assign(canvas.style, { display: "block", width: "100%", maxWidth: "420px", aspectRatio: "42 / 46", margin: "0 auto", touchAction: "pan-y", cursor: "grab" });
    const state = place.querySelector(".robot-state") ?? make("p", { className: "robot-state" });
    if (!state.parentElement) place.append(state);
    state.before(canvas);
    let paints = painter(canvas, data);
    if (!paints) return canvas.remove();
    place.classList.add("is-live");
    const side = { ...VIEW };
    const recorded = data.times.length > 1;
    let [paused, seen, asked, clock, before, described] = [matchMedia("(prefers-reduced-motion: reduce)").matches, true, 0, 0, 0, 0];
    let shown = Object.fromEntries(Object.entries(data.positions).map(([name, values]) => [name, values.at(paused ? -1 : 0)]));
    let target = null;

    const frameSoon = () => requestAnimationFrame(frame);
    const ask = () => (asked ||= !seen ? 0 : paints.gap ? setTimeout(frameSoon, paints.gap) : frameSoon());
    function frame(now) {
      if (!canvas.isConnected) return;
      const passed = Math.min(0.25, (now - before) / 1000);
      [asked, before] = [0, now];
      let moves = false;
      if (target) {
        // Messages come 10 times per second, pictures 60 times: go a part of the way with each.
        const part = paused ? 1 : 1 - Math.exp(-passed / 0.05);
        for (const [name, value] of Object.entries(target)) {
          const from = shown[name] ?? value;
          shown[name] = Math.abs(value - from) < 1e-4 ? value : from + part * (value - from);
          moves ||= shown[name] !== value;
        }
      } else if (recorded && !paused) {
        shown = positionsAt(data, (clock += passed));
        moves = true;
      }
      paints.paint(side, shown);
      if (now - described > 400 || !moves) describe((described = now));
      if (moves) ask();
    }

    function describe() {
      canvas.setAttribute("aria-label", `The robot ${data.name}: ${words(data, shown).join(", ") || "no joint has moved"}. The arrow keys turn it.`);
      const beyond = words(data, shown, isOutside);
      state.textContent = beyond.join(", ") || (Object.keys(shown).length ? "All joints are within their limits." : "No joint has moved yet.");
      state.classList.toggle("is-beyond", beyond.length > 0);
    }

    const turn = (across, up) => {
      side.azimuth += across;
      side.elevation = Math.max(-0.1, Math.min(1.4, side.elevation + up));
      ask();
    };
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => event.buttons && turn(-event.movementX / 120, event.movementY / 160));
    canvas.addEventListener("dblclick", () => (Object.assign(side, VIEW), ask()));
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [0.15, 0], ArrowRight: [-0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      turn(...step);
    });
    // A browser may take the graphics card away, and give it back.
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => ((paints = painter(canvas, data)), ask()));
    new ResizeObserver(ask).observe(canvas);
    new IntersectionObserver(([entry]) => ((seen = entry.isIntersecting), ask())).observe(canvas);

    if (recorded) {
      const pause = make("button", { type: "button", className: "pause" });
      const name = () => (pause.textContent = paused ? "Play" : "Pause");
      pause.addEventListener("click", () => ((paused = !paused), name(), ask()));
      name();
      state.before(pause);
    }
    describe();
    return { move: (positions) => ((target = { ...target, ...positions }), ask()), say: (text) => (state.textContent = text) };
  };
})();
