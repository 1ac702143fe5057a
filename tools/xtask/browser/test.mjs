// The page in Chromium, with WebGPU and without, with a mouse and with a finger.
// node test.mjs ADDRESS CHROMIUM SHADERS

import { readFile } from "node:fs/promises";
import { chromium } from "playwright-core";
import { COLUMNS, differs, grid, mean } from "./pictures.mjs";

const [address, executablePath, shaders] = process.argv.slice(2);

// A GPU in software, which Chromium uses only where it is told to.
const GPU = [
  "--enable-unsafe-webgpu",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
  "--use-angle=swiftshader",
  "--use-webgpu-adapter=swiftshader",
  "--ignore-gpu-blocklist",
];
const QUIET = [
  "--no-sandbox",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];

// Few rays and cells: a GPU in software is slow.
const CELLS = "96x54";
const LIGHT = "set method=raymarch\nset raymarch.rays=2\nset bounces=1\n";
// Mean of all channels, 0 to 255, below which a picture counts as black.
const DARK = 20;
// Largest difference of the means of a channel over a coarse grid by which two pictures are the same
// scene: what WebGPU and WebGL 2 round.
const SAME = 6;

// A warning that is right here: the GPU of this test is a program.
const EXPECTED = "Software rasterizer detected";

// Time after which egui takes a finger that rests for a long click, and more, ms.
const RESTS = 1000;

// Longest wait for anything, ms.
const PATIENCE = 180_000;

/// A page that is open.
class Sandbox {
  constructor(page) {
    this.page = page;
    this.faults = [];
    this.said = [];
    page.on("pageerror", (fault) => this.faults.push(`page error: ${fault.message}`));
    page.on("console", (message) => {
      const warns = message.type() === "warning" && !message.text().includes(EXPECTED);
      if (message.type() === "error" || warns) {
        this.faults.push(`${message.type()}: ${message.text()}`);
      } else {
        this.said.push(message.text());
      }
    });
  }

  static async open(browser, query, { device = {}, before } = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...device });
    context.setDefaultTimeout(PATIENCE);
    if (before) await context.addInitScript(before);
    const sandbox = new Sandbox(await context.newPage());
    const begin = Date.now();
    // Cells as they are, and light that a GPU in software has time for, from the first frame on.
    const script = `factor 1\n${query.includes("backend=gpu") ? LIGHT : ""}`;
    await sandbox.page.goto(`${address}?${query}&script=${encodeURIComponent(script)}`);
    await sandbox.page.waitForFunction(
      () => window.lamplight && document.getElementById("words").textContent !== "loading …",
    );
    sandbox.loaded = Date.now() - begin;
    const words = await sandbox.page.textContent("#words");
    check(words === "", `the page says: ${words}`);
    return sandbox;
  }

  /// Plays lines of a script, and answers what they said.
  async play(lines) {
    const done = `done-${Math.random()}`;
    this.said = [];
    await this.page.evaluate((script) => window.lamplight.play(script), `${lines}\nsay ${done}\n`);
    const end = Date.now() + PATIENCE;
    while (!this.said.includes(done)) {
      check(Date.now() < end, `never came to the end of:\n${lines}\n${this.faults.slice(0, 3).join("\n")}`);
      await new Promise((wake) => setTimeout(wake, 20));
    }
    return this.said.filter((word) => word !== done);
  }

  /// Where the picture lies in the window.
  async place() {
    const [words] = await this.play("place");
    const [x, y, width, height] = words.split(" ").map(Number);
    return { x, y, width, height };
  }

  /// What the picture shows, as mean colours over a grid.
  async picture() {
    return grid(this.page, await this.page.screenshot({ clip: await this.place() }));
  }

  /// The place in the window of a cell.
  async at([x, y]) {
    const place = await this.place();
    const [columns, rows] = CELLS.split("x").map(Number);
    return [place.x + (x / columns) * place.width, place.y + (y / rows) * place.height];
  }

  /// Fails if the page or the browser complained.
  well() {
    check(this.faults.length === 0, this.faults.slice(0, 3).join("\n"));
  }

  async close() {
    this.well();
    await this.page.context().close();
  }
}

/// The page by WebGPU. Tests share it, as a GPU in software takes a minute to compile its shaders.
async function onGpu(shared) {
  shared.sandbox ??= await Sandbox.open(shared.gpu, `backend=gpu&size=${CELLS}`);
  return shared.sandbox;
}

function check(holds, words) {
  if (!holds) throw new Error(words);
}

async function launch(flags) {
  return chromium.launch({ executablePath, args: [...QUIET, ...flags] });
}

async function lit(sandbox, what) {
  const light = mean(await sandbox.picture());
  // What the browser refused is said on its console, and no light comes of it.
  const why = sandbox.faults.slice(0, 3).map((fault) => `\n${fault}`).join("");
  check(light > DARK, `${what} is dark: mean ${light.toFixed(1)}${why}`);
  return light;
}

/// Draws a line by a pointer, and looks whether light is where it was drawn and the rest is as dark as
/// it was.
async function draws(sandbox, drag) {
  await sandbox.play(`world paint\n${LIGHT}clear\nframes 3`);
  const before = await sandbox.picture();
  await drag(await sandbox.at([24, 12]), await sandbox.at([72, 12]));
  await sandbox.play("move 2 52\nframes 3");
  const after = await sandbox.picture();
  // Fields are 6 cells wide and high.
  const line = (picture) => mean(picture.slice(2 * COLUMNS + 5, 2 * COLUMNS + 11));
  const corner = (picture) => mean(picture.slice(8 * COLUMNS, 8 * COLUMNS + 2));
  const [there, away] = [line(after) - line(before), corner(after) - corner(before)];
  const told = `${there.toFixed(1)} brighter where it was drawn, ${away.toFixed(1)} in a corner`;
  check(there > 40 && there > 2 * away, told);
  return told;
}

const mouse = (sandbox) => async (from, to) => {
  const { page } = sandbox;
  await page.mouse.move(...from);
  await sandbox.play("frames 2");
  await page.mouse.down();
  await sandbox.play("frames 2");
  await page.mouse.move(...to, { steps: 5 });
  await sandbox.play("frames 2");
  await page.mouse.up();
};

const finger = (sandbox) => async (from, to) => {
  const touch = await sandbox.page.context().newCDPSession(sandbox.page);
  const send = async (type, points) => {
    const touchPoints = points.map(([x, y]) => ({ x, y }));
    await touch.send("Input.dispatchTouchEvent", { type, touchPoints });
    await sandbox.play("frames 2");
  };
  await send("touchStart", [from]);
  // A finger may rest before it moves.
  await sandbox.page.waitForTimeout(RESTS);
  await sandbox.play("frames 2");
  await send("touchMove", [to]);
  await send("touchEnd", []);
};

/// Drops files on the window, as a browser hands them over: as bytes, each by itself.
async function drop(sandbox, files) {
  const transfer = await sandbox.page.evaluateHandle((files) => {
    const transfer = new DataTransfer();
    for (const [name, bytes] of files) transfer.items.add(new File([new Uint8Array(bytes)], name));
    return transfer;
  }, files.map(([name, bytes]) => [name, [...bytes]]));
  await sandbox.page.dispatchEvent("canvas", "drop", { dataTransfer: transfer });
}

/// Saves by a line of a script, and answers the files that were offered.
async function downloads(sandbox, kind, count) {
  const offered = [];
  sandbox.page.on("download", (download) => offered.push(download));
  await sandbox.play(`save ${kind}\nframes 20`);
  const end = Date.now() + PATIENCE;
  while (offered.length < count) {
    check(Date.now() < end, `save ${kind} offers ${offered.length} of ${count} files`);
    await new Promise((wake) => setTimeout(wake, 20));
  }
  sandbox.page.removeAllListeners("download");
  return Promise.all(offered.map(async (download) => {
    const chunks = [];
    for await (const chunk of await download.createReadStream()) chunks.push(chunk);
    return [download.suggestedFilename(), Buffer.concat(chunks)];
  }));
}

const PHONE = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true };

// A scene that stands still, by a method without noise that is quick in software: the GPU's light is the
// CPU's.
const SCENE = "world paint\nset method=polar\nset bounces=0\nframes 4\n";

const TESTS = {
  async "every shader is WGSL as a browser reads it"({ gpu }) {
    const texts = JSON.parse(await readFile(shaders, "utf8"));
    // One that must fail.
    const broken = { broken: "fn f(a: u32) -> u32 { return a | a << 1u; }" };
    const page = await gpu.newPage();
    await page.goto(`${address}nothing`);
    const judge = async (texts) => page.evaluate(async (texts) => {
      const device = await (await navigator.gpu.requestAdapter()).requestDevice();
      const faults = [];
      for (const [name, code] of Object.entries(texts)) {
        const { messages } = await device.createShaderModule({ code }).getCompilationInfo();
        faults.push(...messages.map(({ lineNum, message }) => `${name}:${lineNum}: ${message}`));
      }
      return faults;
    }, texts);
    const faults = await judge(texts);
    check(faults.length === 0, faults.join("\n"));
    check((await judge(broken)).length > 0, "a broken shader passes");
    await page.close();
    return `${Object.keys(texts).length} of them`;
  },

  async "the page shows light, by WebGPU"(shared) {
    const sandbox = await onGpu(shared);
    await sandbox.play(SCENE);
    const light = await lit(sandbox, "the page");
    shared.pictures.gpu = await sandbox.picture();
    check((await sandbox.play("tell")).join() === "all is well", "something went wrong");
    sandbox.well();
    return `after ${sandbox.loaded} ms, mean ${light.toFixed(1)}`;
  },

  async "every world and method shows light"(shared) {
    const sandbox = await onGpu(shared);
    const told = [];
    const look = async (what, lines) => {
      const words = await sandbox.play(`${lines}frames 3\ntell`);
      check(words.join() === "all is well", `${what}: ${words}`);
      told.push(`${what} ${(await lit(sandbox, what)).toFixed(0)}`);
    };
    for (const world of ["bodies", "sand", "room", "paint"]) {
      await look(world, `${LIGHT}world ${world}\n`);
      if (world === "room") shared.pictures.room = await sandbox.picture();
    }
    for (const method of ["holographic", "cascades", "flood"]) {
      await look(method, `set method=${method}\n`);
    }
    const refused = await sandbox.play("world sand\nset method=polar\nframes 3\ntell");
    check(refused.join().includes("lights lamps only"), `polar in sand says: ${refused}`);
    sandbox.well();
    return told.join(", ");
  },

  async "a mouse paints"(shared) {
    const sandbox = await onGpu(shared);
    const told = await draws(sandbox, mouse(sandbox));
    // Light comes back from the GPU for it.
    const [[name, png]] = await downloads(sandbox, "picture", 1);
    check(name.endsWith(".png") && png.subarray(1, 4).toString() === "PNG", `${name} is no PNG`);
    // The last of those that share it: left open, its frames would slow down the others.
    await sandbox.close();
    shared.sandbox = undefined;
    return told;
  },

  async "without WebGPU the CPU shows the same scene"({ plain, pictures }) {
    const before = () => delete Navigator.prototype.gpu;
    const sandbox = await Sandbox.open(plain, `size=${CELLS}`, { before });
    const [said] = await sandbox.play("tell");
    check(said.includes("no WebGPU") && said.includes("on the CPU"), `the page says: ${said}`);
    await sandbox.play(SCENE);
    const cpu = await sandbox.picture();
    const [same, other] = [differs(cpu, pictures.gpu), differs(cpu, pictures.room)];
    check(same <= SAME, `the CPU's picture is ${same.toFixed(1)} from the GPU's`);
    check(other > SAME, `another world would pass too: it is ${other.toFixed(1)} away`);
    await sandbox.close();
    return `${same.toFixed(1)} apart, another world ${other.toFixed(1)}`;
  },

  async "where WebGPU gives no device the CPU takes over"({ gpu }) {
    const before = () => {
      GPUAdapter.prototype.requestDevice = () => Promise.reject(new Error("no device today"));
      // Else it would not be asked for one.
      Object.defineProperty(GPUAdapterInfo.prototype, "isFallbackAdapter", { get: () => false });
    };
    const sandbox = await Sandbox.open(gpu, "", { before });
    // What the browser itself says about it.
    sandbox.faults = [];
    const [said] = await sandbox.play("tell");
    const told = said.includes("cannot be used") && said.includes("on the CPU");
    check(told, `the page says: ${said}`);
    await lit(sandbox, "the picture");
    await sandbox.close();
    return said;
  },

  async "the CPU keeps up"({ plain }) {
    const sandbox = await Sandbox.open(plain, "backend=cpu&world=sand");
    await sandbox.play("frames 5");
    const begin = Date.now();
    await sandbox.play("frames 60");
    const rate = 61_000 / (Date.now() - begin);
    await lit(sandbox, "the picture");
    await sandbox.close();
    // A machine that is busy with other things still has to be playable.
    check(rate > 4, `only ${rate.toFixed(1)} frames a second`);
    return `${rate.toFixed(1)} frames a second, light after ${sandbox.loaded} ms`;
  },

  async "a bad address is said in words"({ plain }) {
    const query = "backend=cpu&world=moon&size=0x9&seed=3&ref=link";
    const sandbox = await Sandbox.open(plain, query);
    const [said] = await sandbox.play("tell");
    check(said.includes("world=moon") && said.includes("size=0x9"), `the page says: ${said}`);
    check(!said.includes("seed"), `the page says: ${said}`);
    await lit(sandbox, "the picture");
    await sandbox.close();
    return said;
  },

  async "a scene is saved, and dropped on the page again"({ plain }) {
    const sandbox = await Sandbox.open(plain, `backend=cpu&size=${CELLS}`);
    await sandbox.play(SCENE);
    const painted = await sandbox.picture();
    const files = await downloads(sandbox, "scene", 6);
    await sandbox.play("clear\nframes 3");
    check(differs(painted, await sandbox.picture()) > SAME, "nothing was cleared");
    // The scene last: its images have to wait for it.
    const last = ([name]) => (name.endsWith(".toml") ? 1 : 0);
    await drop(sandbox, files.sort((a, b) => last(a) - last(b)));
    await sandbox.play("frames 30");
    await sandbox.play(SCENE.replace("world paint\n", ""));
    const [said] = await sandbox.play("tell");
    check(said === "Undo brings the former canvas back", `after the drop the page says: ${said}`);
    const again = differs(painted, await sandbox.picture());
    check(again <= SAME, `the scene that came back is ${again.toFixed(1)} from what was saved`);
    await sandbox.close();
    return files.map(([name]) => name).join(", ");
  },

  async "a finger paints, on a phone"({ plain }) {
    const sandbox = await Sandbox.open(plain, `backend=cpu&size=${CELLS}`, { device: PHONE });
    const place = await sandbox.place();
    const share = place.width / PHONE.viewport.width;
    check(share > 0.9, `the picture has ${(100 * share).toFixed(0)} % of the width`);
    await lit(sandbox, "the picture");
    const told = await draws(sandbox, finger(sandbox));
    const scrolled = await sandbox.page.evaluate(() => [scrollX, scrollY, visualViewport.scale]);
    check(scrolled.join() === "0,0,1", `the page was scrolled or zoomed: ${scrolled}`);
    await sandbox.close();
    return told;
  },
};

const [gpu, plain] = await Promise.all([launch(GPU), launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])]);
const shared = { gpu, plain, pictures: {} };
let failed = 0;
for (const [name, test] of Object.entries(TESTS)) {
  const begin = Date.now();
  const seconds = () => `${((Date.now() - begin) / 1000).toFixed(1)} s`;
  try {
    const told = await test(shared);
    console.log(`passed in ${seconds()}: ${name}: ${told}`);
  } catch (why) {
    failed += 1;
    console.log(`FAILED after ${seconds()}: ${name}: ${why.message}`);
    // What it left open would slow down the others.
    shared.sandbox = undefined;
    await Promise.all([gpu, plain].flatMap((b) => b.contexts()).map((context) => context.close()));
  }
}
await Promise.all([gpu.close(), plain.close()]);
process.exitCode = failed > 0 ? 1 : 0;
