// three-mesh-bvh (Johnson, for three.js) as an outside tracer: answers a rays file of bvhbench
// (framework/workload/exchange.h) with a hits file, and prints its speed on one thread, warm.
//   npm install --prefix . && node trace.mjs a.rays a.hits [--quality=center|average|sah]
import { readFileSync, writeFileSync } from 'node:fs';
import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three';
import { AVERAGE, CENTER, MeshBVH, SAH } from 'three-mesh-bvh';

const NONE = 0xFFFFFFFF, UNNAMED = 0x7FFFFFFF;
const strategies = { center: CENTER, average: AVERAGE, sah: SAH };

function fail(text) {
  console.error(`trace.mjs: ${text}`);
  process.exit(2);
}

function readRays(path) {
  let file;
  try {
    file = readFileSync(path);
  } catch (error) {
    fail(`${path}: ${error.code}`);
  }
  const view = new DataView(file.buffer, file.byteOffset, file.length);
  const word = at => view.getUint32(at, true), long = at => Number(view.getBigUint64(at, true));
  if (file.length < 1024 || file.toString('latin1', 0, 8) !== 'BVHBRAYS') fail(`${path} is no rays file`);
  if (word(8) !== 4 || word(12) !== 0x01020304 || word(16) !== 1024 || word(24) !== 1)
    fail(`${path} is of a version that this program does not know`);
  const [rays, vertices, triangles, spheres] = [32, 40, 48, 56].map(long);
  if (spheres > 0 || long(976) > 0) fail(`${path} has spheres or boxes: this is for triangles`);
  const floats = (at, count) => new Float32Array(file.buffer.slice(file.byteOffset + at, file.byteOffset + at + 4 * count));
  const behind = 1024 + 32 * rays, indices = behind + 12 * vertices;
  if (file.length !== indices + 12 * triangles) fail(`${path} is truncated`);
  return { any: word(20) === 1, count: rays, rays: floats(1024, 8 * rays), vertices: floats(behind, 3 * vertices),
           indices: new Uint32Array(floats(indices, 3 * triangles).buffer), hashes: file.subarray(64, 80) };
}

// Builds a tree that leaves the order of the indices as it is, so that its faces are our triangles.
function build(scene, strategy) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(scene.vertices, 3));
  geometry.setIndex(new BufferAttribute(scene.indices, 1));
  return new MeshBVH(geometry, { strategy, indirect: true });
}

// Distances of three-mesh-bvh are lengths, ours are in units of the direction.
function trace(bvh, { any, count, rays }, hits) {
  const ray = new Ray(new Vector3(), new Vector3());
  for (let i = 0; i < count; i++) {
    const at = 8 * i, length = Math.hypot(rays[at + 4], rays[at + 5], rays[at + 6]);
    ray.origin.set(rays[at], rays[at + 1], rays[at + 2]);
    ray.direction.set(rays[at + 4], rays[at + 5], rays[at + 6]).divideScalar(length);
    const hit = bvh.raycastFirst(ray, DoubleSide, rays[at + 3] * length, rays[at + 7] * length);
    hits.setFloat32(8 * i, hit === null ? Infinity : any ? 0 : hit.distance / length, true);
    hits.setUint32(8 * i + 4, hit === null ? NONE : any ? UNNAMED : hit.faceIndex, true);
  }
}

// Milliseconds of one call, on average over half a second, after as long a time in which the engine
// compiles what is called often.
function clock(work) {
  let ms = 0;
  for (let round = 0; round < 2; round++) {
    const start = performance.now();
    let calls = 0, taken = 0;
    for (; taken < 500; taken = performance.now() - start, calls++) work();
    ms = taken / calls;
  }
  return ms;
}

const [from, to, option = '--quality=sah'] = process.argv.slice(2);
const strategy = strategies[option.replace('--quality=', '')];
if (to === undefined || strategy === undefined) fail('usage: trace.mjs RAYS HITS [--quality=center|average|sah]');
const scene = readRays(from), header = Buffer.alloc(128), hits = Buffer.alloc(8 * scene.count);
const bvh = build(scene, strategy), answers = new DataView(hits.buffer, hits.byteOffset, hits.length);
const buildMs = clock(() => build(scene, strategy)), traceMs = clock(() => trace(bvh, scene, answers));
header.write('BVHBHITS', 0, 'latin1');
header.writeUInt32LE(4, 8);
header.writeUInt32LE(0x01020304, 12);
header.writeUInt32LE(128, 16);
header.writeBigUInt64LE(BigInt(scene.count), 24);
scene.hashes.copy(header, 32); // of the scene and of the rays; no checksum
header.write('three-mesh-bvh', 56, 'latin1');
writeFileSync(to, Buffer.concat([header, hits]));
console.log(JSON.stringify({ build_ms: buildMs, mrays_s: scene.count / traceMs / 1e3 }));
