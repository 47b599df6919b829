// Jolt's distance constraint on the scenes that `compare --describe` writes; prints rows of peers.csv.
//
// Usage: node jolt_peer.mjs FOLDER

import { readFileSync, readdirSync } from "node:fs";
import { basename, join } from "node:path";
import initJolt from "jolt-physics/wasm-compat";

const RATES = [60, 240, 960];
const COLLISION_STEPS = [1, 4, 16];
const version = JSON.parse(readFileSync("node_modules/jolt-physics/package.json")).version;

function read(path) {
  const scene = { bodies: [], links: [], truth: new Map() };
  for (const line of readFileSync(path, "utf8").trim().split("\n")) {
    const [key, ...words] = line.split(" ");
    const numbers = words.map(Number);
    if (key === "body") scene.bodies.push(numbers);
    else if (key === "link") scene.links.push(numbers);
    else if (key === "at") scene.truth.set(Math.round(numbers[0] * 240), numbers.slice(1));
    else scene[key] = numbers;
  }
  return scene;
}

const Jolt = await initJolt();

function world(gravity) {
  const settings = new Jolt.JoltSettings();
  // One layer that collides with nothing.
  settings.mObjectLayerPairFilter = new Jolt.ObjectLayerPairFilterTable(1);
  const broad = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  broad.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(
    broad, 1, settings.mObjectLayerPairFilter, 1);
  const jolt = new Jolt.JoltInterface(settings);
  jolt.GetPhysicsSystem().SetGravity(new Jolt.Vec3(...gravity));
  return jolt;
}

function spawn(bodies, [mass, x, y, z, ...v]) {
  const kind = mass > 0 ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static;
  const settings = new Jolt.BodyCreationSettings(
    new Jolt.SphereShape(0.05), new Jolt.RVec3(x, y, z), new Jolt.Quat(0, 0, 0, 1), kind, 0);
  // Both are not zero by default.
  settings.mLinearDamping = 0;
  settings.mAngularDamping = 0;
  settings.mAllowSleeping = false;
  if (mass > 0) {
    settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_CalculateInertia;
    settings.mMassPropertiesOverride.mMass = mass;
    settings.mLinearVelocity = new Jolt.Vec3(...v);
  }
  const body = bodies.CreateBody(settings);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  return body;
}

function follow(scene, rate, collisionSteps) {
  const jolt = world(scene.gravity);
  const system = jolt.GetPhysicsSystem();
  const bodies = scene.bodies.map((b) => spawn(system.GetBodyInterface(), b));
  for (const [a, b, stiffness, damping, rest] of scene.links) {
    const settings = new Jolt.DistanceConstraintSettings();
    settings.mSpace = Jolt.EConstraintSpace_WorldSpace;
    settings.mPoint1 = bodies[a].GetPosition();
    settings.mPoint2 = bodies[b].GetPosition();
    settings.mMinDistance = rest;
    settings.mMaxDistance = rest;
    settings.mLimitsSpringSettings.mMode = Jolt.ESpringMode_StiffnessAndDamping;
    settings.mLimitsSpringSettings.mStiffness = stiffness;
    settings.mLimitsSpringSettings.mDamping = damping;
    system.AddConstraint(settings.Create(bodies[a], bodies[b]));
  }
  let worst = 0;
  const spent = [];
  const steps = Math.round(scene.seconds[0] * rate);
  for (let step = 1; step <= steps; step++) {
    const before = process.hrtime.bigint();
    jolt.Step(1 / rate, collisionSteps);
    spent.push(Number(process.hrtime.bigint() - before) / 1e3);
    const truth = scene.truth.get((step * 240) / rate);
    if (truth === undefined) continue;
    scene.watched.forEach((body, i) => {
      const p = bodies[body].GetPosition();
      const off = Math.hypot(p.GetX() - truth[3 * i], p.GetY() - truth[3 * i + 1], p.GetZ() - truth[3 * i + 2]);
      if (!(off <= worst)) worst = off;
    });
    if (!(worst <= 10 * scene.size[0])) break;
  }
  spent.sort((a, b) => a - b);
  Jolt.destroy(jolt);
  return [worst, !(worst <= 10 * scene.size[0]), spent[spent.length >> 1]];
}

const folder = process.argv[2];
for (const file of readdirSync(folder).sort()) {
  const scene = read(join(folder, file));
  for (const n of COLLISION_STEPS) {
    for (const rate of RATES) {
      const [error, diverged, step] = follow(scene, rate, n);
      const setting = n === 1 ? "1 collision step" : `${n} collision steps`;
      console.log(`Jolt (npm ${version}) distance,${setting},${basename(file, ".txt")},${rate},${error.toExponential(3)},${Number(diverged)},${step.toFixed(1)}`);
    }
  }
}
