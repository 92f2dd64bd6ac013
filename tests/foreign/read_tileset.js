// loaders.gl: node read_tileset.js tileset.json; prints its tiles as JSON.
import { readFileSync } from "node:fs";
import { parse } from "@loaders.gl/core";
import { Tiles3DLoader } from "@loaders.gl/3d-tiles";

const file = process.argv[2];
const options = { worker: false, "3d-tiles": { isTileset: true, loadGLTF: false } };
const tileset = await parse(readFileSync(file), Tiles3DLoader, options, { url: file });
const tiles = [];
const visit = (tile) => {
  const { type, refine, children } = tile;
  const n_children = children.length;
  tiles.push({ type, refine, n_children, error: tile.lodMetricValue, url: tile.contentUrl ?? null, box: tile.boundingVolume.box });
  tile.children.forEach(visit);
};
visit(tileset.root);
console.log(JSON.stringify({ type: tileset.type, version: tileset.asset.version, tiles }));
