// Files that are dropped on the page, the theme of the system, and keys: one component, which shows two targets.
"use strict";
window.wheelrail_page = {
  install(app) {
    app.component("wr-drop", {
      props: { largest: { type: Number, default: 1e7 } },
      emits: ["file", "dark", "reset"],
      data: () => ({ over: false }),
      mounted() {
        this.$emit("dark", window.matchMedia("(prefers-color-scheme: dark)").matches);
        this.listeners = {
          dragover: (event) => { event.preventDefault(); this.over = true; },
          dragleave: (event) => { if (!event.relatedTarget) this.over = false; },
          drop: (event) => { event.preventDefault(); this.over = false; },
          keydown: (event) => {
            const typing = /INPUT|TEXTAREA/.test(event.target.tagName) && event.target.type !== "range";
            if (event.key === "r" && !typing && !event.ctrlKey && !event.metaKey) this.$emit("reset");
          },
        };
        for (const [name, listener] of Object.entries(this.listeners)) window.addEventListener(name, listener);
      },
      beforeUnmount() {
        for (const [name, listener] of Object.entries(this.listeners)) window.removeEventListener(name, listener);
      },
      methods: {
        async read(kind, file) {
          this.over = false;
          if (!file) return;
          const content = file.size > this.largest ? null : new Uint8Array(await file.arrayBuffer());
          this.$emit("file", { name: file.name, size: file.size, kind, content });
        },
      },
      template: `
        <div>
          <div class="wr-pick">
            <label v-for="kind in ['wheel', 'rail']" :key="kind">{{ kind }} profile from a file
              <input type="file" :class="'wr-file-' + kind" @change="read(kind, $event.target.files[0]); $event.target.value = ''">
            </label>
          </div>
          <div v-if="over" class="wr-drop">
            <div v-for="kind in ['wheel', 'rail']" :key="kind" :class="'wr-target-' + kind"
                 @dragover.prevent @drop.prevent="read(kind, $event.dataTransfer.files[0])">{{ kind }} profile</div>
          </div>
        </div>`,
    });
  },
};
