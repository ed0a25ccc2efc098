-- A database as version 0.1.0 wrote it: six answers, the last one withdrawn, one token.
BEGIN TRANSACTION;
CREATE TABLE answer (
	submission VARCHAR(36) NOT NULL, 
	item VARCHAR(64) NOT NULL, 
	score INTEGER, 
	PRIMARY KEY (submission, item), 
	FOREIGN KEY(submission) REFERENCES submission (id)
);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','fabric_texture',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','fabric_colour',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','fabric_lustre',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','thickness_texture',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','silhouette',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','detail_structure',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','pleat',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','perspective',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','static_drape',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','static_overall',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','dynamic_swing',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000000','dynamic_drape',1);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','fabric_texture',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','fabric_colour',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','fabric_lustre',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','thickness_texture',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','silhouette',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','detail_structure',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','pleat',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','perspective',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','static_drape',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','static_overall',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','dynamic_swing',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000001','dynamic_drape',2);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','fabric_texture',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','fabric_colour',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','fabric_lustre',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','thickness_texture',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','silhouette',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','detail_structure',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','pleat',NULL);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','perspective',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','static_drape',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','static_overall',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','dynamic_swing',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000002','dynamic_drape',3);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','fabric_texture',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','fabric_colour',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','fabric_lustre',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','thickness_texture',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','silhouette',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','detail_structure',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','pleat',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','perspective',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','static_drape',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','static_overall',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','dynamic_swing',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000003','dynamic_drape',4);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','fabric_texture',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','fabric_colour',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','fabric_lustre',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','thickness_texture',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','silhouette',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','detail_structure',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','pleat',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','perspective',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','static_drape',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','static_overall',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','dynamic_swing',5);
INSERT INTO "answer" VALUES('00000000-0000-4000-8000-000000000004','dynamic_drape',5);
CREATE TABLE submission (
	id VARCHAR(36) NOT NULL, 
	questionnaire VARCHAR(64) NOT NULL, 
	version INTEGER NOT NULL, 
	language VARCHAR(2) NOT NULL, 
	exhibit VARCHAR(64), 
	digest VARCHAR(64) NOT NULL, 
	received DATETIME NOT NULL, 
	withdrawn DATETIME, 
	PRIMARY KEY (id)
);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000000','garment',1,'zh','pibo','ca5d327b202ed85ad76b2d9d3a0973eef14ddde70982cb7011e7e3595392ddac','2026-11-21 08:02:53.000000',NULL);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000001','garment',1,'zh','pibo','f598d67361318a1a8383a8b82bbbbb849c1084bb0ad1904b1e57a55ce922d81c','2026-11-21 08:02:53.000000',NULL);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000002','garment',1,'zh','pibo','939fd76ce1ff4dcf7fb8a8407e4bb0c28b57cc68146d7ea278d3f20d54adae05','2026-11-21 08:02:53.000000',NULL);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000003','garment',1,'zh','pibo','6e2763dcbb32d2bc629e0b575d9b16afc018184b42bb995b507736e6179f516d','2026-11-21 08:02:53.000000',NULL);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000004','garment',1,'zh','pibo','662f692db25341aa6361de4eef79a2d923feb01a5a67ed78ea0d41238d54ccc3','2026-11-21 08:02:53.000000',NULL);
INSERT INTO "submission" VALUES('00000000-0000-4000-8000-000000000005','garment',1,'zh',NULL,'','2026-11-21 08:02:53.000000','2026-11-21 08:02:53.000000');
CREATE TABLE suggestion (
	submission VARCHAR(36) NOT NULL, 
	module VARCHAR(64) NOT NULL, 
	text TEXT NOT NULL, 
	PRIMARY KEY (submission, module), 
	FOREIGN KEY(submission) REFERENCES submission (id)
);
INSERT INTO "suggestion" VALUES('00000000-0000-4000-8000-000000000000','form','意见 0');
INSERT INTO "suggestion" VALUES('00000000-0000-4000-8000-000000000001','form','意见 1');
INSERT INTO "suggestion" VALUES('00000000-0000-4000-8000-000000000002','form','意见 2');
INSERT INTO "suggestion" VALUES('00000000-0000-4000-8000-000000000003','form','意见 3');
INSERT INTO "suggestion" VALUES('00000000-0000-4000-8000-000000000004','form','意见 4');
CREATE TABLE token (
	id INTEGER NOT NULL, 
	label VARCHAR(200) NOT NULL, 
	digest VARCHAR(64) NOT NULL, 
	made DATETIME NOT NULL, 
	PRIMARY KEY (id), 
	UNIQUE (digest)
);
INSERT INTO "token" VALUES(1,'Dr Lin','b6ef1585dde40b314e3e2fbe5714412043e27bdea53f9e25d66714208528e967','2026-11-21 08:02:53.000000');
CREATE TABLE version (
	questionnaire VARCHAR(64) NOT NULL, 
	version INTEGER NOT NULL, 
	digest VARCHAR(64) NOT NULL, 
	document JSON NOT NULL, 
	PRIMARY KEY (questionnaire, version)
);
INSERT INTO "version" VALUES('garment',1,'20b92ffff970dcd0fbc52234610b2873122f17f5ca227e929a1602ca60ac32e2','{"id": "garment", "version": 1, "title": {"zh": "\u670d\u9970\u6a21\u62df\u6548\u679c\u8bc4\u4ef7", "en": "How the simulated garment looks"}, "intro": {"zh": "\u8bf7\u5148\u8fd1\u89c2\u5c55\u54c1\uff0c\u8f6c\u52a8\u5b83\uff0c\u770b\u4e00\u770b\u7ec7\u7269\u3001\u7248\u578b\u4e0e\u60ac\u5782\u7684\u52a8\u753b\uff0c\u518d\u6309\u60a8\u7684\u89c2\u611f\u6253\u5206\u3002\u6ca1\u6709\u5bf9\u9519\uff0c\u7ea6\u9700\u4e09\u5206\u949f\u3002", "en": "Please look at the exhibit closely, turn it, watch the film of its drape, and then rate what you see. There are no wrong answers. It takes about three minutes."}, "consent": {"zh": "\u6211\u5e74\u6ee1\u5341\u516b\u5468\u5c81\uff0c\u6216\u5df2\u5f97\u5230\u76d1\u62a4\u4eba\u7684\u540c\u610f\uff1b\u6211\u540c\u610f\u672c\u9986\u4fdd\u5b58\u4ee5\u4e0a\u8bc4\u5206\u4e0e\u5efa\u8bae\uff0c\u4ec5\u7528\u4e8e\u7814\u7a76\u548c\u6539\u8fdb\u5c55\u5385\u3002\u95ee\u5377\u4e0d\u8bb0\u5f55\u59d3\u540d\u3001\u7f51\u7edc\u5730\u5740\u4e0e\u6d4f\u89c8\u5668\u4fe1\u606f\u3002\u63d0\u4ea4\u540e\u4f1a\u5f97\u5230\u4e00\u4e2a\u64a4\u56de\u7801\uff0c\u51ed\u6b64\u7801\u53ef\u4ee5\u968f\u65f6\u64a4\u56de\u56de\u7b54\u3002\u5efa\u8bae\u680f\u8bf7\u4e0d\u8981\u5199\u5165\u4e2a\u4eba\u4fe1\u606f\u3002", "en": "I am at least eighteen years old or have a guardian''s permission, and I agree that the hall keeps these ratings and suggestions, for research and for improving the hall only. No name, network address or browser information is recorded. After sending I receive a withdrawal code with which I can take my answers back. I write nothing personal into the suggestions."}, "scale": {"anchors": [{"zh": "\u5f88\u5dee", "en": "Very poor"}, {"zh": "\u8f83\u5dee", "en": "Rather poor"}, {"zh": "\u4e00\u822c", "en": "Average"}, {"zh": "\u8f83\u597d", "en": "Rather good"}, {"zh": "\u5f88\u597d", "en": "Very good"}], "not_seen": {"zh": "\u672a\u770b\u5230", "en": "Not seen"}}, "dimension": [], "module": [{"id": "fabric", "title": {"zh": "\u9762\u6599\u7279\u6027", "en": "The fabric"}, "intro": null, "suggestion": {"zh": "\u5bf9\u9762\u6599\u7684\u5efa\u8bae\uff08\u53ef\u4e0d\u586b\uff09", "en": "Suggestions on the fabric (optional)"}, "item": [{"id": "fabric_texture", "label": {"zh": "\u9762\u6599\u7eb9\u7406", "en": "Fabric texture"}, "hint": {"zh": "\u7ec7\u7eb9\u4e0e\u56fe\u6848\u662f\u5426\u6e05\u695a\u3001\u81ea\u7136", "en": "Are weave and pattern clear and natural?"}, "tags": [], "required": true, "dimension": null}, {"id": "fabric_colour", "label": {"zh": "\u9762\u6599\u8272\u5f69", "en": "Fabric colour"}, "hint": {"zh": "\u8272\u76f8\u3001\u9971\u548c\u5ea6\u3001\u660e\u5ea6\u4e0e\u642d\u914d", "en": "Hue, saturation, brightness and how the colours go together"}, "tags": [], "required": true, "dimension": null}, {"id": "fabric_lustre", "label": {"zh": "\u9762\u6599\u5149\u6cfd", "en": "Fabric lustre"}, "hint": {"zh": "\u8f6c\u52a8\u65f6\u7684\u53cd\u5149\u662f\u5426\u50cf\u771f\u7684\u7ec7\u7269", "en": "Does it catch the light like real cloth when turned?"}, "tags": [], "required": true, "dimension": null}, {"id": "thickness_texture", "label": {"zh": "\u539a\u5ea6\u8d28\u611f", "en": "Thickness and hand"}, "hint": {"zh": "\u770b\u4e0a\u53bb\u7684\u539a\u8584\u4e0e\u624b\u611f", "en": "How thick it looks and how it would feel to the hand"}, "tags": [], "required": true, "dimension": null}]}, {"id": "form", "title": {"zh": "\u7248\u578b\u7279\u6027", "en": "Cut and form"}, "intro": null, "suggestion": {"zh": "\u5bf9\u7248\u578b\u7684\u5efa\u8bae\uff08\u53ef\u4e0d\u586b\uff09", "en": "Suggestions on cut and form (optional)"}, "item": [{"id": "silhouette", "label": {"zh": "\u670d\u88c5\u5ed3\u5f62", "en": "Silhouette"}, "hint": {"zh": "\u6574\u4f53\u7684\u5916\u8f6e\u5ed3", "en": "The outline of the whole"}, "tags": [], "required": true, "dimension": null}, {"id": "detail_structure", "label": {"zh": "\u7ec6\u8282\u7ed3\u6784", "en": "Detail structure"}, "hint": {"zh": "\u9886\u3001\u895f\u3001\u8896\u3001\u6446\u7b49\u5c40\u90e8\uff1b\u6ca1\u6709\u65f6\u770b\u8fb9\u7f18", "en": "Collar, placket, sleeves, hem; where there are none, the edges"}, "tags": [], "required": true, "dimension": null}, {"id": "pleat", "label": {"zh": "\u8936\u76b1\u6548\u679c", "en": "Pleats and folds"}, "hint": {"zh": "\u8936\u7684\u8d70\u5411\u3001\u6df1\u6d45\u662f\u5426\u5408\u7406", "en": "Do the folds run and deepen as they should?"}, "tags": [], "required": true, "dimension": null}, {"id": "perspective", "label": {"zh": "\u900f\u89c6\u6548\u679c", "en": "Perspective effect"}, "hint": {"zh": "\u4ece\u4e0d\u540c\u8fdc\u8fd1\u4e0e\u89d2\u5ea6\u770b\uff0c\u5f62\u4e0e\u5c42\u6b21\u662f\u5426\u53ef\u4fe1", "en": "Are shape and layers convincing from near, far and all sides?"}, "tags": [], "required": true, "dimension": null}]}, {"id": "still", "title": {"zh": "\u9759\u6001\u6548\u679c", "en": "At rest"}, "intro": null, "suggestion": {"zh": "\u5bf9\u9759\u6001\u6548\u679c\u7684\u5efa\u8bae\uff08\u53ef\u4e0d\u586b\uff09", "en": "Suggestions on the garment at rest (optional)"}, "item": [{"id": "static_drape", "label": {"zh": "\u9759\u6001\u60ac\u5782\u6548\u679c", "en": "Static drape"}, "hint": {"zh": "\u9759\u6b62\u65f6\u5782\u4e0b\u6765\u7684\u6837\u5b50", "en": "How it hangs when nothing moves"}, "tags": ["static"], "required": true, "dimension": null}, {"id": "static_overall", "label": {"zh": "\u9759\u6001\u6574\u4f53\u6548\u679c", "en": "Static overall effect"}, "hint": {"zh": "\u9759\u6b62\u65f6\u7684\u6574\u4f53\u89c2\u611f", "en": "The whole impression when nothing moves"}, "tags": ["static"], "required": true, "dimension": null}]}, {"id": "motion", "title": {"zh": "\u52a8\u6001\u6548\u679c", "en": "In motion"}, "intro": {"zh": "\u8bf7\u770b\u5c55\u54c1\u7684\u60ac\u5782\u5f71\u7247\uff1b\u6ca1\u6709\u770b\u7684\u8bf7\u9009\u201c\u672a\u770b\u5230\u201d\u3002", "en": "Please watch the film of the drape; if you have not, choose \u201cNot seen\u201d."}, "suggestion": {"zh": "\u5bf9\u52a8\u6001\u6548\u679c\u7684\u5efa\u8bae\uff08\u53ef\u4e0d\u586b\uff09", "en": "Suggestions on the motion (optional)"}, "item": [{"id": "dynamic_swing", "label": {"zh": "\u52a8\u6001\u6446\u52a8\u6548\u679c", "en": "Dynamic swing"}, "hint": {"zh": "\u6446\u52a8\u7684\u5e45\u5ea6\u4e0e\u8282\u594f", "en": "How far and in what rhythm it swings"}, "tags": ["dynamic"], "required": true, "dimension": null}, {"id": "dynamic_drape", "label": {"zh": "\u52a8\u6001\u60ac\u5782\u6548\u679c", "en": "Dynamic drape"}, "hint": {"zh": "\u8fd0\u52a8\u4e2d\u5782\u843d\u3001\u56de\u7a33\u7684\u6837\u5b50", "en": "How it falls and settles while moving"}, "tags": ["dynamic"], "required": true, "dimension": null}]}]}');
CREATE INDEX submission_by_questionnaire ON submission (questionnaire, version);
COMMIT;
