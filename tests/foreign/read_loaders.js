// loaders.gl: node read_loaders.js FILE.glb; prints tables of properties and numbers of features as JSON.
import { readFileSync } from "node:fs";
import { parse } from "@loaders.gl/core";
import { GLTFLoader } from "@loaders.gl/gltf";

const bytes = readFileSync(process.argv[2]);
const content = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const { json } = await parse(content, GLTFLoader, { worker: false, gltf: { loadBuffers: true, loadImages: false } });
const plain = (values) => (values === undefined ? null : Array.from(values, (value) => (typeof value === "bigint" ? value.toString() : value)));
const tables = (json.extensions?.EXT_structural_metadata?.propertyTables ?? []).map((table) =>
  Object.fromEntries(Object.entries(table.properties).map(([key, property]) => [key, plain(property.data)])),
);
const features = Object.fromEntries(
  (json.meshes ?? []).map((mesh) => [
    mesh.name,
    plain(mesh.primitives[0].extensions?.EXT_mesh_features?.featureIds?.[0].data),
  ]),
);
console.log(JSON.stringify({ tables, features }));
