// Babylon.js without a screen: node read_babylon.js FILE.glb; prints Gaussians and meshes as JSON, in glTF's frame.
import { readFileSync } from "node:fs";
import { ImportMeshAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { VertexBuffer } from "@babylonjs/core/Buffers/buffer.js";
import { NullEngine } from "@babylonjs/core/Engines/nullEngine.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { GaussianSplattingMesh } from "@babylonjs/core/Meshes/GaussianSplatting/gaussianSplattingMesh.js";
import { Scene } from "@babylonjs/core/scene.js";
import "@babylonjs/loaders/glTF/index.js";

const BYTES_OF_SPLAT = 32;
const splats = [];
// Without a screen there are no textures to put Gaussians in: they are caught on the way there.
GaussianSplattingMesh.prototype.updateDataAsync = async function (data, harmonics, options, degree) {
  const bytes = new Uint8Array(data);
  const numbers = new Float32Array(data);
  const found = { name: this.name, parent: this.parent?.name ?? null, degree, positions: [], scales: [], colours: [] };
  for (let i = 0; i < data.byteLength / BYTES_OF_SPLAT; i++) {
    found.positions.push([...numbers.subarray(8 * i, 8 * i + 3)]);
    found.scales.push([...numbers.subarray(8 * i + 3, 8 * i + 6)]);
    found.colours.push([...bytes.subarray(32 * i + 24, 32 * i + 28)]);
  }
  splats.push(found);
};

const scene = new Scene(new NullEngine());
scene.useRightHandedSystem = true;
const loaded = await ImportMeshAsync(new Uint8Array(readFileSync(process.argv[2])), scene, { pluginExtension: ".glb" });
const meshes = loaded.meshes
  .filter((mesh) => mesh.getTotalVertices() > 0)
  .map((mesh) => {
    const world = mesh.computeWorldMatrix(true);
    const corners = mesh.getVerticesData(VertexBuffer.PositionKind);
    const placed = [];
    for (let i = 0; i < corners.length; i += 3) {
      placed.push(Vector3.TransformCoordinates(Vector3.FromArray(corners, i), world).asArray());
    }
    return { name: mesh.name, corners: placed, visibility: mesh.material.alpha };
  });
console.log(JSON.stringify({ splats, meshes }));
process.exit(0);
