"use strict";
const at = (id) => document.getElementById(id);
const GREY = "#999999";
const PERIOD = 250;
let map = null, version = 0, state = null, space = null, failures = 0;

const colour = (label) => ABOUT.colours[label] || GREY;
const percent = (share) => share === null || share === undefined ? "?" : `${Math.round(100 * share)} %`;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function make(kind, text, name) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  if (name) made.className = name;
  return made;
}

// ---------------------------------------------------------------- beside the map

function showRoom() {
  const area = state.area, room = at("room").firstElementChild;
  const known = area && area.label !== "unknown";
  room.textContent = known ? area.label : "not known yet";
  at("room-sure").textContent = known ? `area ${area.id}, ${percent(area.confidence)} sure` : "";
}

function bar(name, said, all) {
  const cue = make("div", undefined, all ? "cue all" : "cue"), line = make("p");
  line.append(make("span", name, "name"), make("span", `${said.label} ${percent(said.confidence)}`, "said"));
  const track = make("div", undefined, "bar"), fill = make("span");
  fill.style.width = `${100 * (said.confidence || 0)}%`;
  fill.style.background = colour(said.label);
  track.append(fill);
  cue.append(line, track);
  return cue;
}

function showNow() {
  const belief = state.belief, now = at("now");
  if (state.stamp === undefined) return;
  if (!belief) {
    now.replaceChildren(make("p", "nothing can be said of this moment", "note"));
    return;
  }
  const names = Object.keys(belief.cues);
  const rows = [bar(names.length > 1 ? "all cues" : names[0] || "belief", belief, names.length > 1)];
  if (names.length > 1) names.forEach((name) => rows.push(bar(name, belief.cues[name], false)));
  if (belief.missing.length) rows.push(make("p", `missing: ${belief.missing.join(", ")}`, "note"));
  now.replaceChildren(...rows);
}

function showPace() {
  const rows = [];
  for (const [name, value] of Object.entries(state.more)) rows.push(make("dt", name), make("dd", value));
  at("pace").replaceChildren(...rows);
}

function showLegend() {
  const labels = [...new Set(map.areas.map((area) => area.label))].sort();
  at("legend").replaceChildren(...labels.map((label) => {
    const entry = make("li"), sign = make("i");
    sign.style.background = colour(label);
    entry.append(sign, label);
    return entry;
  }));
}

// ---------------------------------------------------------------- the map

function paint(picture) {
  // The greys of the picture become the colours of the page: free, unseen, wall.
  const canvas = document.createElement("canvas");
  canvas.width = picture.width; canvas.height = picture.height;
  const pen = canvas.getContext("2d");
  pen.drawImage(picture, 0, 0);
  const data = pen.getImageData(0, 0, canvas.width, canvas.height), pixels = data.data;
  const rgb = (name) => [1, 3, 5].map((i) => parseInt(css(name).slice(i, i + 2), 16));
  const shades = {0: rgb("--free"), 128: rgb("--unseen"), 255: rgb("--wall")};
  for (let i = 0; i < pixels.length; i += 4) {
    const shade = shades[pixels[i]] || shades[128];
    [pixels[i], pixels[i + 1], pixels[i + 2]] = shade;
  }
  pen.putImageData(data, 0, 0);
  return canvas;
}

function loadSpace() {
  if (!map.space) { space = null; draw(); return; }
  const picture = new Image();
  picture.onload = () => { space = {picture, drawn: paint(picture), of: map.space}; draw(); };
  picture.src = `data:image/png;base64,${map.space.png}`;
}

function bounds() {
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const take = ([x, y]) => {
    low = [Math.min(low[0], x), Math.min(low[1], y)];
    high = [Math.max(high[0], x), Math.max(high[1], y)];
  };
  if (map) {
    map.areas.forEach((area) => { area.way.forEach(take); area.surface.forEach((p) => p[0].forEach(take)); });
    map.nodes.forEach(take);
  }
  if (state && state.pose) take(state.pose);
  return low[0] > high[0] ? null : [low, high];
}

function centroid(ring) {
  let twice = 0, u = 0, v = 0;
  ring.forEach(([x, y], i) => {
    const [a, b] = ring[(i + 1) % ring.length], cross = x * b - a * y;
    twice += cross; u += (x + a) * cross; v += (y + b) * cross;
  });
  return {size: Math.abs(twice) / 2, at: twice ? [u / (3 * twice), v / (3 * twice)] : ring[0]};
}

function middle(area) {
  // Of its largest surface, or else of its way.
  const surfaces = area.surface.map((polygon) => centroid(polygon[0])).sort((a, b) => b.size - a.size);
  if (surfaces.length) return surfaces[0].at;
  return area.way.length ? area.way[Math.floor(area.way.length / 2)] : null;
}

function draw() {
  const canvas = at("map"), ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const box = bounds();
  if (!box) return;
  const [low, high] = box, margin = 36;
  const scale = Math.min((width - 2 * margin) / Math.max(high[0] - low[0], 4),
    (height - 2 * margin) / Math.max(high[1] - low[1], 4));
  const x = (u) => width / 2 + (u - (low[0] + high[0]) / 2) * scale;
  const y = (v) => height / 2 - (v - (low[1] + high[1]) / 2) * scale;
  if (space) {
    const {drawn, of} = space;
    pen.imageSmoothingEnabled = false;
    pen.drawImage(drawn, x(of.x), y(of.y + drawn.height * of.cell), drawn.width * of.cell * scale,
      drawn.height * of.cell * scale);
  }
  if (map) { drawAreas(pen, x, y); drawNodes(pen, x, y); drawNames(pen, x, y); }
  drawScale(pen, scale, width);
  if (state && state.pose) drawRobot(pen, x, y, state.pose);
}

function drawAreas(pen, x, y) {
  for (const area of map.areas) {
    pen.fillStyle = colour(area.label);
    pen.globalAlpha = area.label === "unknown" ? 0.25 : 0.25 + 0.5 * (area.confidence || 0);
    for (const polygon of area.surface) {
      pen.beginPath();
      for (const ring of polygon) {
        ring.forEach(([u, v], i) => i ? pen.lineTo(x(u), y(v)) : pen.moveTo(x(u), y(v)));
        pen.closePath();
      }
      pen.fill("evenodd");
    }
    pen.globalAlpha = 1;
    if (!area.surface.length) area.way.forEach(([u, v]) => dot(pen, x(u), y(v), 2.5));
  }
}

function drawNodes(pen, x, y) {
  for (const [u, v, gateway] of map.nodes) {
    pen.fillStyle = css(gateway ? "--robot" : "--dim");
    dot(pen, x(u), y(v), gateway ? 3.5 : 1.6);
  }
}

function dot(pen, u, v, radius) {
  pen.beginPath(); pen.arc(u, v, radius, 0, 2 * Math.PI); pen.fill();
}

function drawNames(pen, x, y) {
  // The largest first; a name that would lie over another is left out.
  const taken = [], sized = [...map.areas].sort((a, b) => b.way.length - a.way.length);
  pen.font = "600 13px system-ui, sans-serif";
  pen.textAlign = "center"; pen.textBaseline = "middle";
  for (const area of sized) {
    const place = middle(area);
    if (!place || area.label === "unknown") continue;
    const text = `${area.label} ${percent(area.confidence)}`, w = pen.measureText(text).width + 10;
    const half = w / 2, wide = at("map").clientWidth;
    const u = Math.min(Math.max(x(place[0]), half + 2), wide - half - 2), v = y(place[1]);
    const box = [u - half, v - 10, u + half, v + 10];
    if (taken.some((t) => box[0] < t[2] && box[2] > t[0] && box[1] < t[3] && box[3] > t[1])) continue;
    taken.push(box);
    pen.fillStyle = css("--panel"); pen.globalAlpha = 0.85;
    pen.fillRect(box[0], box[1], w, 20);
    pen.globalAlpha = 1; pen.fillStyle = css("--text");
    pen.fillText(text, u, v);
  }
}

function drawScale(pen, scale, width) {
  const lengths = [0.5, 1, 2, 5, 10, 20, 50, 100, 200];
  const metres = lengths.find((length) => length * scale >= 60) || 500;
  const right = width - 14, left = right - metres * scale;
  pen.strokeStyle = pen.fillStyle = css("--text");
  pen.lineWidth = 2;
  pen.beginPath(); pen.moveTo(left, 22); pen.lineTo(right, 22); pen.stroke();
  pen.font = "12px system-ui, sans-serif"; pen.textAlign = "right"; pen.textBaseline = "alphabetic";
  pen.fillText(`${metres} m`, right, 16);
}

function drawRobot(pen, x, y, [u, v, theta]) {
  pen.save();
  pen.translate(x(u), y(v)); pen.rotate(-theta);
  pen.beginPath(); pen.moveTo(11, 0); pen.lineTo(-7, 7); pen.lineTo(-4, 0); pen.lineTo(-7, -7);
  pen.closePath();
  pen.fillStyle = css("--robot"); pen.strokeStyle = css("--back"); pen.lineWidth = 1.5;
  pen.fill(); pen.stroke();
  pen.restore();
}

// ---------------------------------------------------------------- asking

function show(told) {
  state = told;
  version = told.version;
  showRoom(); showNow(); showPace();
  at("link").textContent = told.ended ? "ended" : "live";
  if (told.map) { map = told.map; showLegend(); loadSpace(); } else draw();
}

async function ask() {
  try {
    const answer = await fetch(`/state?map=${version}`);
    if (!answer.ok) throw new Error(answer.statusText);
    failures = 0;
    show(await answer.json());
  } catch (error) {
    failures += 1;
    at("link").textContent = state && state.ended ? "ended" : "no connection; trying again";
    if (failures === 1) console.info(`placecue: ${error}`);
  }
  setTimeout(ask, PERIOD * Math.min(1 + failures, 8));
}

at("title").textContent = ABOUT.title;
document.title = `${ABOUT.title} - placecue live`;
addEventListener("resize", draw);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  if (space) space.drawn = paint(space.picture);
  draw();
});
ask();
